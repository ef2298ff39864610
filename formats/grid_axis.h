// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/range_grid.h"

namespace dubsar {

/// The axis along which a grid's depths were measured, whatever frame its samples are in.
struct GridAxis {
  Eigen::Vector3d axis;        ///< unit, of either sign
  double clearness = 0;        ///< how many times more the samples stray along it than square to it
  Eigen::Vector3d along_rows;  ///< unit, from row to row across the axis
  Eigen::Vector3d along_cols;  ///< unit, from column to column across the axis
};

/// A sample lies where its row and column put it, but for its depth: what row and column leave of the samples
/// (least squares) lies along the axis. Seen through a camera's rays it is their middle. Nothing where the
/// grid has too few samples or they lie as its rows and columns say.
[[nodiscard]] std::optional<GridAxis> grid_axis(const RangeGrid& grid);

}  // namespace dubsar
