// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dubsar::usb_stage {

using Clock = std::chrono::steady_clock;

/// How long a firmware may take to answer before it counts as gone.
inline constexpr std::chrono::milliseconds kAnswer(1500);
/// When a question that may be asked twice is: its answer may have been spoilt on the line.
inline constexpr std::chrono::milliseconds kAskAgain(300);

/// As a duration of the clock, a day at most: what is reckoned from a device's numbers may be any length.
[[nodiscard]] inline Clock::duration duration_of(double seconds) {
  constexpr double kDayS = 86400;
  return std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(std::clamp(seconds, 0.0, kDayS)));
}

/// Bytes to and from a controller. An error means that the controller is gone for good.
class Link {
 public:
  virtual ~Link() = default;
  /// Within half a second; from any thread.
  virtual Status write(std::string_view bytes) = 0;
  /// What came, as soon as something did; empty when nothing came in time. One thread at a time.
  virtual Result<std::string> read(std::chrono::milliseconds timeout) = 0;
};

}  // namespace dubsar::usb_stage
