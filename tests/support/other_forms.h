// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/range_grid.h"
#include "core/rigid_transform.h"

/// A scan as other programs may write it.
namespace dubsar::test {

/// Coordinates in whole steps.
inline RangeGrid rounded(RangeGrid grid, double step_mm) {
  for (auto* axis : {&grid.x, &grid.y, &grid.z}) {
    std::ranges::transform(*axis, axis->begin(), [step_mm](float v) {
      return static_cast<float>(std::round(static_cast<double>(v) / step_mm) * step_mm);
    });
  }
  return grid;
}

/// A grid of rows × cols whose cell (row, col) is that which `from` names: an index into `grid`.
template <class From>
RangeGrid rearranged(const RangeGrid& grid, int rows, int cols, const From& from) {
  RangeGrid out = grid;
  out.intensity.clear();
  out.rgb.clear();
  out.confidence.clear();
  out.allocate(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const std::size_t to = out.index(row, col);
      const std::size_t i = from(row, col);
      out.x[to] = grid.x[i];
      out.y[to] = grid.y[i];
      out.z[to] = grid.z[i];
      out.valid[to] = grid.valid[i];
    }
  }
  return out;
}

inline RangeGrid transposed(const RangeGrid& grid) {
  return rearranged(grid, grid.cols, grid.rows, [&](int row, int col) { return grid.index(col, row); });
}

/// The last column first.
inline RangeGrid reversed(const RangeGrid& grid) {
  return rearranged(grid, grid.rows, grid.cols,
                    [&](int row, int col) { return grid.index(row, grid.cols - 1 - col); });
}

/// What lies between these parts of the rows and columns that hold samples.
inline RangeGrid cropped(const RangeGrid& grid, double from, double to) {
  Eigen::Array2i low(grid.rows, grid.cols);
  Eigen::Array2i high(0, 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      const Eigen::Array2i cell(grid.row_of(i), grid.col_of(i));
      low = low.min(cell);
      high = high.max(cell + 1);
    }
  }
  const Eigen::Array2d extent = (high - low).cast<double>();
  const Eigen::Array2i first = low + (from * extent).cast<int>();
  const Eigen::Array2i count = low + (to * extent).cast<int>() - first;
  return rearranged(grid, count[0], count[1],
                    [&](int row, int col) { return grid.index(first[0] + row, first[1] + col); });
}

inline RangeGrid moved(RangeGrid grid, const RigidTransform& to_from) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      const Eigen::Vector3d p = to_from * grid.point(i).cast<double>();
      grid.x[i] = static_cast<float>(p.x());
      grid.y[i] = static_cast<float>(p.y());
      grid.z[i] = static_cast<float>(p.z());
    }
  }
  grid.view.direction = to_from.rotation * grid.view.direction;
  return grid;
}

}  // namespace dubsar::test
