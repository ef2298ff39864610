// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <cstdint>

namespace dubsar::aravis {

/// Whether a GigE Vision camera is still there: asks it on a socket of its own with the one command that
/// every device answers to everybody (DISCOVERY). Aravis finds out as well, but after some four seconds, and
/// an ordinary register read waits as long.
class Presence {
 public:
  /// address: IPv4, in network byte order.
  explicit Presence(std::uint32_t address);
  ~Presence();
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;

  /// Asks when the last question is old enough, takes what came, and says whether the camera has kept silent
  /// for too long, of the time in which somebody looked: where this machine stood still the camera is not to
  /// blame. Does not wait. quiet() is for when its frames come and there is nothing to ask.
  [[nodiscard]] bool gone();
  void quiet();
  /// True when it has answered since gone() began to ask.
  [[nodiscard]] bool has_answered() const { return answered_; }
  /// True when questions have gone unanswered of late: it may turn out to be gone.
  [[nodiscard]] bool is_doubtful() const { return silent_ > 2 * kAskEvery; }

  static constexpr std::chrono::milliseconds kAskEvery{200};
  static constexpr std::chrono::milliseconds kSilence{1300};

 private:
  using Clock = std::chrono::steady_clock;
  int socket_ = -1;
  std::uint16_t number_ = 0;
  Clock::time_point asked_{};
  Clock::time_point looked_ = Clock::now();
  Clock::duration silent_{};
  bool answered_ = false;
};

}  // namespace dubsar::aravis
