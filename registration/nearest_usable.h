// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "registration/scan_surface.h"

namespace dubsar {

/// The usable sample of `level` nearest to p within reach_mm, or -1. What the camera saw straight at p bounds
/// the search, so that it seldom looks farther than the next cell; where nothing was seen, only the next
/// cells are searched: the nearest sample would be one of the border.
[[nodiscard]] std::int64_t nearest_usable(const SurfaceLevel& level, const Eigen::Vector3f& p,
                                          float reach_mm);

/// The same for many points at once; `found` is as long as they are. The samples of a level are more than a
/// processor's own memory holds, and one point waits for four reads after each other: of many, all wait for
/// each of the four together.
void nearest_usable(const SurfaceLevel& level, std::span<const Eigen::Vector3f> points, float reach_mm,
                    std::span<GridLookup::Found> found);

/// False where p lies nearer to a sample beside `found`, its nearest usable one, that may not be matched: p
/// lies beyond the border of what may, and found is merely the last of it. Such partners lie all to one side,
/// and what normals make of that distance along a curved surface pulls the two scans apart.
[[nodiscard]] bool lies_on(const SurfaceLevel& level, const GridLookup::Found& found,
                           const Eigen::Vector3f& p);

/// Tukey's weight; pairs far off say nothing.
[[nodiscard]] inline double tukey_weight(double residual, double scale) {
  const double u = residual / (4.685 * scale);
  const double v = 1.0 - u * u;
  return v > 0 ? v * v : 0.0;
}

}  // namespace dubsar
