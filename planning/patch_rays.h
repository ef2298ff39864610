// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "planning/model_surface.h"

namespace dubsar {

/// Beyond any object.
inline constexpr double kFarFromPatchMm = 1.0e4;
inline constexpr int kPatchRays = 9;

/// Where the rays of a patch against its normal begin, above it: a sunflower spread over it, the first in the
/// middle.
[[nodiscard]] inline std::array<Eigen::Vector3d, kPatchRays> patch_ray_starts(const SurfacePatch& patch,
                                                                              double step_mm) {
  // The expected hull may lie inside the real surface. Above it there is nothing that could be met.
  constexpr double kLiftMm = 5.0;
  const Eigen::Vector3d u = patch.normal.unitOrthogonal();
  const Eigen::Vector3d v = patch.normal.cross(u);
  const double reach_mm = std::max(1.5 * step_mm, 0.45 * std::sqrt(patch.area_mm2));
  std::array<Eigen::Vector3d, kPatchRays> starts;
  for (int k = 0; k < kPatchRays; ++k) {
    const double radius = reach_mm * std::sqrt(static_cast<double>(k) / (kPatchRays - 1));
    const double angle = 2.399963229728653 * k;
    starts[static_cast<std::size_t>(k)] = patch.position_mm + kLiftMm * patch.normal +
                                          radius * std::cos(angle) * u + radius * std::sin(angle) * v;
  }
  return starts;
}

}  // namespace dubsar
