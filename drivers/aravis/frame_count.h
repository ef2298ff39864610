// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace dubsar::aravis {

/// Numbers the frames of a stream from 1 on and tells how many are missing: from the camera's own numbers
/// while one connection lasts, and from the time that passed, at the rate of the frames before, where the
/// camera had to be taken anew in between.
class FrameCount {
 public:
  struct Step {
    std::uint64_t id = 0;
    std::uint64_t lost = 0;  ///< frames that did not come before this one
    /// The camera itself began anew before this one: its clock does not go on, nor does what it counts.
    bool camera_restarted = false;
  };

  /// Another stream begins.
  void begin();
  /// The same stream goes on over a new connection: its numbers go on from the last frame's.
  void go_on();
  /// `raw`: the camera's number, which goes round from 65535 to 1 in GigE Vision 1. `device_ns`: the camera's
  /// time, 0 where it has none.
  Step take(std::uint64_t raw, std::int64_t timestamp_ns, std::int64_t device_ns);
  /// From frame to frame, as those of late came; nothing before there are two.
  [[nodiscard]] std::optional<double> period_ns() const;

 private:
  struct Seen {
    std::uint64_t id = 0;
    std::int64_t timestamp_ns = 0, device_ns = 0;
  };
  [[nodiscard]] std::uint64_t missed_until(std::int64_t timestamp_ns) const;

  std::uint64_t last_raw_ = 0;  ///< 0: none yet over this connection
  std::optional<Seen> last_;
  std::deque<Seen> of_late_;
};

}  // namespace dubsar::aravis
