// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
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

/// The words for what a file's numbers are, and the same as a sentence has them.
inline constexpr std::array<std::string_view, 5> kLengthUnits{"m", "cm", "mm", "um", "in"};
inline constexpr std::string_view kLengthUnitsText = "m, cm, mm, um or in";

/// Millimetres per unit for the words above; nothing for any other.
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
  if (unit == "cm") {
    return 10.0;
  }
  if (unit == "in") {
    return 25.4;
  }
  return std::nullopt;
}

}  // namespace dubsar
