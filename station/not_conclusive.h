// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include <fmt/format.h>

namespace dubsar {

/// Why a verdict is not conclusive, in words for one line. No red at all is no sample that could be red: what
/// is not registered says nothing of the clay.
[[nodiscard]] inline std::string not_conclusive(double red_mm2) {
  constexpr double kLeastToldMm2 = 0.05;
  if (red_mm2 <= 0) {
    return "not conclusive: no scan is registered, nothing is known of the clay";
  }
  return red_mm2 < kLeastToldMm2 ? "not conclusive: less than 0.1 mm2 are still red"
                                 : fmt::format("not conclusive: about {:.1f} mm2 are still red", red_mm2);
}

/// What a conclusive verdict does not speak of, to be put behind it; nothing where all was in reach.
[[nodiscard]] inline std::string out_of_reach(double unreachable_mm2) {
  constexpr double kLeastToldMm2 = 0.05;
  return unreachable_mm2 < kLeastToldMm2
             ? std::string()
             : fmt::format("; about {:.1f} mm2 are out of reach and not recorded: the checklist says why",
                           unreachable_mm2);
}

}  // namespace dubsar
