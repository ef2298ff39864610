// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>

// NOLINTNEXTLINE(bugprone-reserved-identifier): the name that Aravis gave it
typedef struct _ArvGvDevice ArvGvDevice;

namespace dubsar::aravis {

/// How a camera's clock stands to ours (CLOCK_MONOTONIC): what its times are on ours.
class CameraClock {
 public:
  /// `offset_ns`: ours less the camera's, where it could be asked.
  explicit CameraClock(std::optional<std::int64_t> offset_ns) : asked_(offset_ns) {}

  /// A time of the camera, of a frame that came at `arrived_ns` of ours. No frame comes before it was taken:
  /// the quickest one corrects an offset that was not asked for, or has drifted. One that was asked for is
  /// not believed when it makes a frame take longer than it can.
  [[nodiscard]] std::int64_t ours(std::int64_t camera_ns, std::int64_t arrived_ns);

 private:
  std::optional<std::int64_t> asked_, offset_;
};

/// Latches the clock of a GigE Vision camera (its bootstrap registers) a few times and takes the answer that
/// came soonest; nothing where the camera has no clock or does not latch it. Good to half of that answer's
/// time.
[[nodiscard]] std::optional<std::int64_t> latched_offset_ns(ArvGvDevice* device);

}  // namespace dubsar::aravis
