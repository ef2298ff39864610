// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// The front-most sample of a grid per cell of a raster across the viewing direction: answers in one memory
/// read what the scan's camera saw at a place and how high it was. Immutable after construction.
class DepthRaster {
 public:
  DepthRaster() = default;
  /// Over the valid samples of `grid`; cell_mm > 0 where the grid has samples.
  DepthRaster(const RangeGrid& grid, double cell_mm);

  struct Cell {
    Eigen::Vector3f point_mm{0, 0, 0};  ///< of the sample: one read tells all of it
    std::int32_t sample = -1;           ///< index in the grid, -1 where nothing was seen
  };

  /// Height of p towards the camera.
  [[nodiscard]] float height(const Eigen::Vector3f& p_mm) const { return up_.dot(p_mm); }
  [[nodiscard]] float height(const Cell& cell) const { return up_.dot(cell.point_mm); }
  /// The cell that p projects to, or nullptr outside the raster.
  [[nodiscard]] const Cell* at(const Eigen::Vector3f& p_mm) const {
    const float u = (u_axis_.dot(p_mm) - u_min_) * per_cell_;
    const float v = (v_axis_.dot(p_mm) - v_min_) * per_cell_;
    if (!(u >= 0 && v >= 0 && u < static_cast<float>(width_) && v < static_cast<float>(height_))) {
      return nullptr;
    }
    return &cells_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(u)];
  }
  /// True when everything seen within `reach` cells around p was seen farther than margin_mm behind p, and
  /// all of these cells did see something: the scan's rays went through p.
  [[nodiscard]] bool seen_through(const Eigen::Vector3f& p_mm, float margin_mm, int reach) const;
  /// True when nothing was seen within `reach` cells around p.
  [[nodiscard]] bool empty_around(const Eigen::Vector3f& p_mm, int reach) const;
  /// True when the scan's rows and columns reach over p and its depth is among those that were seen: a
  /// surface there that faces the camera should have given a return.
  [[nodiscard]] bool in_field(const Eigen::Vector3f& p_mm) const;
  [[nodiscard]] double cell_mm() const { return per_cell_ > 0 ? 1.0 / static_cast<double>(per_cell_) : 0.0; }

 private:
  void fit_field(const RangeGrid& grid);

  Eigen::Vector3f u_axis_{1, 0, 0}, v_axis_{0, 1, 0}, up_{0, 0, 1};
  float u_min_ = 0, v_min_ = 0, per_cell_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<Cell> cells_;
  /// (row, col) as an affine function of (u, v, 1): where the grid's field ends.
  Eigen::Matrix<float, 2, 3> row_col_from_uv_ = Eigen::Matrix<float, 2, 3>::Zero();
  Eigen::Vector2f rows_cols_{0, 0};
  float low_height_ = 0, high_height_ = 0;
};

}  // namespace dubsar
