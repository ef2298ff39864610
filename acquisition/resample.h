// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/job.h"
#include "core/point_cloud.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

struct ResampleOptions {
  /// Unit vector from the scanner to the object; unset: see resample().
  std::optional<Eigen::Vector3d> view_direction;
  double spacing_mm = 0;  ///< µ of the grid; 0: the median distance of a point to its nearest neighbour
  /// Cells of µ that the grid may have at most: a few stray points far away must not blow it up.
  std::int64_t max_cells = std::int64_t{1} << 27;

  [[nodiscard]] Status check() const;
};

/// Rearranges points without an order in a grid (seed 001, 3.2: "or simply by resampling") by projecting them
/// along the view. A cell takes, of the points that fall into it, the one nearest to its middle on the side
/// that the scanner sees first: points that lie behind it by more than 3µ are another surface. Every sample
/// is a point as it was measured: nothing is averaged, moved or invented, and cells that no point falls into
/// stay empty.
///
/// The view is, in this order: options.view_direction; against the mean of the normals where they agree;
/// view_axis(), seen from its +z end unless the outline shows that it was the other. The cells
/// are as wide as the larger of µ and what an even spread needs, so that a regular cloud leaves no empty rows
/// by aliasing.
///
/// The grid's samples stay in the frame of the points. Columns run along the frame's x as far as the view
/// allows, turned by at most 45° to follow the rows that the points were scanned in. Points that are not
/// finite are left out. Errors: kBadInput when fewer than three points are left or all lie on a spot;
/// kCancelled.
[[nodiscard]] Result<RangeGrid> resample(const PointCloud& cloud, const ResampleOptions& options,
                                         JobContext& job);

}  // namespace dubsar
