// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_geometry.h"

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// Difference along one grid direction over the neighbours that are on the same sheet; zero when there is
/// none. `complete` is false when either neighbour is missing or across a step.
Eigen::Vector3f difference(const RangeGrid& grid, int row, int col, int d_row, int d_col, float step2_mm2,
                           bool& complete) {
  const Eigen::Vector3f here = grid.point(grid.index(row, col));
  Eigen::Vector3f ahead = here;
  Eigen::Vector3f behind = here;
  bool has_ahead = grid.is_valid(row + d_row, col + d_col);
  if (has_ahead) {
    ahead = grid.point(grid.index(row + d_row, col + d_col));
    has_ahead = (ahead - here).squaredNorm() <= step2_mm2;
  }
  bool has_behind = grid.is_valid(row - d_row, col - d_col);
  if (has_behind) {
    behind = grid.point(grid.index(row - d_row, col - d_col));
    has_behind = (behind - here).squaredNorm() <= step2_mm2;
  }
  complete = complete && has_ahead && has_behind;
  return (has_ahead ? ahead : here) - (has_behind ? behind : here);
}

}  // namespace

GridGeometry grid_geometry(const RangeGrid& grid, double step_factor) {
  GridGeometry out;
  out.normals.assign(grid.size(), Eigen::Vector3f::Zero());
  out.boundary.assign(grid.size(), 0);
  const auto step_mm = static_cast<float>(step_factor * grid.spacing_mm);
  const float step2_mm2 = step_mm * step_mm;
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = grid.index(row, col);
          if (grid.valid[i] == 0) {
            continue;
          }
          bool complete = true;
          const Eigen::Vector3f along = difference(grid, row, col, 0, 1, step2_mm2, complete);
          const Eigen::Vector3f across = difference(grid, row, col, 1, 0, step2_mm2, complete);
          out.boundary[i] = complete ? 0 : 1;
          const Eigen::Vector3f n = along.cross(across);
          const float length = n.norm();
          if (length <= 1e-12F) {
            continue;
          }
          const Eigen::Vector3f to_camera =
              grid.view.to_camera(grid.point(i).cast<double>(), row).cast<float>();
          out.normals[i] = n * ((n.dot(to_camera) < 0 ? -1.0F : 1.0F) / length);
        }
      },
      8);
  return out;
}

}  // namespace dubsar
