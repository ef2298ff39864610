// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <numbers>
#include <optional>
#include <string_view>

namespace dubsar {

inline constexpr double kPi = std::numbers::pi;

[[nodiscard]] constexpr double rad_from_deg(double deg) {
  return deg * kPi / 180.0;
}
[[nodiscard]] constexpr double deg_from_rad(double rad) {
  return rad * 180.0 / kPi;
}

/// Millimetres per unit for "m", "mm", "um"; nothing for any other word.
[[nodiscard]] constexpr std::optional<double> mm_per_unit(std::string_view unit) {
  if (unit == "mm") {
    return 1.0;
  }
  if (unit == "m") {
    return 1000.0;
  }
  if (unit == "um") {
    return 0.001;
  }
  return std::nullopt;
}

}  // namespace dubsar
