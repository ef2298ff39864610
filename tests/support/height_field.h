// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>

#include "core/range_grid.h"

namespace dubsar::test {

/// A rectilinear grid over z = height(x, y), seen from +z, centred on the origin.
template <class Height>
RangeGrid height_field(int rows, int cols, double spacing_mm, const Height& height) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  grid.spacing_mm = spacing_mm;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = grid.index(row, col);
      const double x = (col - 0.5 * (cols - 1)) * spacing_mm;
      const double y = (row - 0.5 * (rows - 1)) * spacing_mm;
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(height(x, y));
      grid.valid[i] = 1;
    }
  }
  return grid;
}

}  // namespace dubsar::test
