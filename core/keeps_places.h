// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <limits>

namespace dubsar {

/// Whether float keeps places that far from the origin to a small part of their spacing: rounded to an eighth
/// of it at the most, samples keep what noise leaves of them.
[[nodiscard]] inline bool keeps_places(double farthest_mm, double spacing_mm) {
  constexpr double kStepsPerSpacing = 8;
  /// Whatever the spacing, rounding to a tenth of a micrometre takes nothing away.
  constexpr double kSurelyPreciseMm = 1000;
  const double step_mm = farthest_mm * static_cast<double>(std::numeric_limits<float>::epsilon());
  return farthest_mm < kSurelyPreciseMm || kStepsPerSpacing * step_mm <= spacing_mm;
}

}  // namespace dubsar
