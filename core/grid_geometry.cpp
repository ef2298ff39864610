// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/parallel.h"
#include "core/row_camera.h"

namespace dubsar {

namespace {

/// The valid cells of one row; none above the first row and below the last.
struct Row {
  const RangeGrid* grid;
  std::size_t first;
  bool inside;

  Row(const RangeGrid& of, int row)
      : grid(&of), first(of.index(std::clamp(row, 0, of.rows - 1), 0)), inside(row >= 0 && row < of.rows) {}

  /// From p to the sample at a column; zero where it is not valid or across a step.
  bool step_to(int col, const Eigen::Vector3f& p, float step2_mm2, Eigen::Vector3f& step) const {
    const std::size_t i = first + static_cast<std::size_t>(col);
    const float x = grid->x[i] - p.x();
    const float y = grid->y[i] - p.y();
    const float z = grid->z[i] - p.z();
    const bool holds = inside && grid->valid[i] != 0 && x * x + y * y + z * z <= step2_mm2;
    step = holds ? Eigen::Vector3f(x, y, z) : Eigen::Vector3f(0, 0, 0);
    return holds;
  }
};

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
        const Row here(grid, row), above(grid, row - 1), below(grid, row + 1);
        const RowCamera camera(grid.view, row);
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = here.first + static_cast<std::size_t>(col);
          if (grid.valid[i] == 0) {
            continue;
          }
          const Eigen::Vector3f p = grid.point(i);
          Eigen::Vector3f after(0, 0, 0), before(0, 0, 0), down, up;
          const bool has_after = col + 1 < grid.cols && here.step_to(col + 1, p, step2_mm2, after);
          const bool has_before = col > 0 && here.step_to(col - 1, p, step2_mm2, before);
          const bool has_below = below.step_to(col, p, step2_mm2, down);
          const bool has_above = above.step_to(col, p, step2_mm2, up);
          out.boundary[i] = has_after && has_before && has_below && has_above ? 0 : 1;
          const Eigen::Vector3f n = (after - before).cross(down - up);
          const float length = n.norm();
          if (length > 1e-12F) {
            out.normals[i] = n * ((n.dot(camera.from(p)) < 0 ? -1.0F : 1.0F) / length);
          }
        }
      },
      8);
  return out;
}

}  // namespace dubsar
