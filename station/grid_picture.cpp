// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/grid_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

// Rows before the newest whose flags are not final yet (planning/sparse_flags.h).
static_assert(GridPicture::kUnsettledRows > 2);

std::uint8_t shade_of(const RangeGrid& grid, int row, int col) {
  const std::size_t i = grid.index(row, col);
  const auto next = [&](int r, int c) { return grid.is_valid(r, c) ? grid.index(r, c) : i; };
  const auto at = [&](std::size_t k) { return Eigen::Vector3d(grid.x[k], grid.y[k], grid.z[k]); };
  const Eigen::Vector3d along_cols = at(next(row, col + 1)) - at(next(row, col - 1));
  const Eigen::Vector3d along_rows = at(i) - at(next(row - 1, col));
  Eigen::Vector3d normal = along_cols.cross(along_rows);
  if (!(normal.squaredNorm() > 0)) {
    return 150;
  }
  normal.normalize();
  const Eigen::Vector3d towards = grid.view.to_camera(at(i), row);
  if (normal.dot(towards) < 0) {
    normal = -normal;
  }
  const Eigen::Vector3d light = Eigen::Vector3d(-0.5, 0.5, 0).normalized() * 0.6 + towards * 0.8;
  return static_cast<std::uint8_t>(std::clamp(40.0 + 210.0 * std::max(0.0, normal.dot(light)), 0.0, 255.0));
}

}  // namespace

void GridPicture::append(const RangeGrid& grid, const SampleFlags& flags, int row) {
  if (row < rows || cols != grid.cols) {
    *this = {};
    cols = grid.cols;
  }
  const int from = std::max(0, std::min(rows, row) - kUnsettledRows);
  rows = row + 1;
  const std::size_t cells = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  shade.resize(cells, 0);
  state.resize(cells, CellState::kNone);
  for (int r = from; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const std::size_t i = grid.index(r, c);
      if (grid.valid[i] == 0) {
        continue;
      }
      shade[i] = shade_of(grid, r, c);
      state[i] = i < flags.size() && is_red(flags[i]) ? CellState::kRed : CellState::kSampled;
    }
  }
}

GridPicture picture_of(const RangeGrid& grid, const SampleFlags& flags) {
  GridPicture picture;
  if (grid.rows > 0) {
    picture.append(grid, flags, grid.rows - 1);
  }
  return picture;
}

}  // namespace dubsar
