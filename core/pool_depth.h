// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dubsar {

/// How many buffers a camera gets when nobody asks for a number: enough for the half second that a program
/// without the right to real-time priority may wait for a processor on a busy machine, in at most 256 MiB.
/// `most`: what the driver can have. A rate of 0 is one that nobody knows.
[[nodiscard]] inline std::uint32_t pool_depth(double rate_hz, std::uint64_t frame_bytes, std::uint32_t most) {
  constexpr double kHiccupS = 0.5;
  constexpr double kLeast = 8;
  constexpr double kUnknownRateHz = 60;
  constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20U;
  const std::uint64_t room =
      std::clamp<std::uint64_t>(kMostBytes / std::max<std::uint64_t>(frame_bytes, 1), 4, most);
  const double wanted = std::max(kLeast, std::ceil(kHiccupS * (rate_hz > 0 ? rate_hz : kUnknownRateHz)));
  return static_cast<std::uint32_t>(std::min(wanted, static_cast<double>(room)));
}

}  // namespace dubsar
