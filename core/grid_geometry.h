// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// Normals and depth steps read off the grid's own structure.
struct GridGeometry {
  std::vector<Eigen::Vector3f>
      normals;  ///< [rows*cols], unit, out of the surface (towards the camera); zero if undefined
  /// [rows*cols], 1 where the sample is valid and one of its four neighbours is missing or across a depth
  /// step.
  std::vector<std::uint8_t> boundary;
};

/// Normals by central differences over neighbours that are not across a depth step. A depth step is a
/// distance of more than step_factor · µ between neighbours (3µ marks a slope of about 70°; seed 001, 3.3).
/// grid.spacing_mm must be > 0.
[[nodiscard]] GridGeometry grid_geometry(const RangeGrid& grid, double step_factor = 5.0);
/// The same with a depth step of more than `step_mm`: the grid's own spacing may be unknown (0).
[[nodiscard]] GridGeometry grid_geometry_within(const RangeGrid& grid, double step_mm);

}  // namespace dubsar
