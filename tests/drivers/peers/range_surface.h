// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>

namespace dubsar::test {

constexpr double kSurfacePerColumnMm = 0.05;
constexpr double kSurfaceDepthMm = 0.0005;

/// What an emulated range camera sees where the stage stands at y: waves whose flanks rise by up to 0.75 mm a
/// millimetre, so that a profile that is put in the wrong place shows.
inline double surface_mm(double x_mm, double y_mm) {
  return 5 + 0.1 * x_mm + 0.3 * std::sin(2.5 * y_mm);
}

}  // namespace dubsar::test
