// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace dubsar {

/// Where one axis of a stage was, from what it told while it moved. One thread adds, others ask.
class PositionTrack {
 public:
  /// A position that was true at `timestamp_ns`, give or take `uncertainty_ns`. Times ascend; one that does
  /// not is left out.
  void add(std::int64_t timestamp_ns, double position, std::int64_t uncertainty_ns);
  /// No more come.
  void close();

  struct Place {
    double position = 0;
    double sigma = 0;  ///< standard deviation, from how long the answers around it took
  };
  /// The position at a time: least squares of a parabola through the readings around it, those that are
  /// known less well counting less. Waits until readings behind that time are there. Nothing outside of what
  /// was told, once it is closed.
  [[nodiscard]] std::optional<Place> at(std::int64_t timestamp_ns);
  /// Waits until it is closed; false when it was not in time.
  bool wait_closed(std::chrono::milliseconds at_most);
  [[nodiscard]] std::optional<double> last() const;
  /// No reading is later than that, and none will come.
  [[nodiscard]] bool closed_before(std::int64_t timestamp_ns) const;

 private:
  struct Reading {
    std::int64_t timestamp_ns;
    double position;
    double uncertainty_s;
  };
  [[nodiscard]] Place fitted(std::size_t after, std::int64_t timestamp_ns) const;

  mutable std::mutex mutex_;
  std::condition_variable more_;
  std::vector<Reading> readings_;
  bool closed_ = false;
};

}  // namespace dubsar
