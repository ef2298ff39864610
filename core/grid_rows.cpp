// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_rows.h"

#include <cstddef>

namespace dubsar {

namespace {

/// Calls with the arrays of both that belong together, and how many values of it a cell has.
void for_each_array(const RangeGrid& from, RangeGrid& to, const auto& call) {
  call(from.x, to.x, 1);
  call(from.y, to.y, 1);
  call(from.z, to.z, 1);
  call(from.valid, to.valid, 1);
  call(from.intensity, to.intensity, 1);
  call(from.rgb, to.rgb, 3);
  call(from.confidence, to.confidence, 1);
}

}  // namespace

RangeGrid rows_of(const RangeGrid& grid, int first, int count) {
  RangeGrid out;
  out.rows = count;
  out.cols = grid.cols;
  const auto cells = static_cast<std::size_t>(grid.cols);
  const auto copy = [&](const auto& from, auto& to, std::size_t values_per_cell) {
    if (!from.empty()) {
      const auto begin = from.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(first) * cells *
                                                                    values_per_cell);
      to.assign(begin, begin + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(count) * cells *
                                                           values_per_cell));
    }
  };
  for_each_array(grid, out, copy);
  out.spacing_mm = grid.spacing_mm;
  out.view = grid.view;
  for (std::optional<Eigen::Vector3d>* const at_first_row : {&out.view.laser_mm, &out.view.camera_mm}) {
    if (*at_first_row) {
      **at_first_row += first * grid.view.motion_per_row_mm;
    }
  }
  out.nominal = grid.nominal;
  out.pin_tip_diameter_mm = grid.pin_tip_diameter_mm;
  out.timestamp_ns = grid.timestamp_ns;
  out.device = grid.device;
  out.source = grid.source;
  return out;
}

bool append_rows(RangeGrid& grid, const RangeGrid& rows) {
  if (grid.rows == 0) {
    grid = rows;
    return true;
  }
  bool same = grid.cols == rows.cols;
  for_each_array(rows, grid, [&](const auto& from, const auto& to, std::size_t /*values_per_cell*/) {
    same = same && from.empty() == to.empty();
  });
  if (!same) {
    return false;
  }
  for_each_array(rows, grid, [](const auto& from, auto& to, std::size_t /*values_per_cell*/) {
    to.insert(to.end(), from.begin(), from.end());
  });
  grid.rows += rows.rows;
  return true;
}

}  // namespace dubsar
