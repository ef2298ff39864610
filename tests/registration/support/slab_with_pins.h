// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.h"
#include "core/range_grid.h"

namespace dubsar::testing {

/// A pin above a slab: a ball with a cone that runs level along +x, seen from straight above.
struct SlabPin {
  Eigen::Vector3d tip_mm{0, 0, 3};
  double radius_mm = 0.6;
  double length_mm = 6;
  bool ball = true;  ///< else the arm is cut off square
};

struct Slab {
  int rows = 300, cols = 400;
  double spacing_mm = 0.1;
  double noise_mm = 0.01;
  std::uint64_t seed = 4;
  bool clay = true;  ///< 30 × 24 mm at z = 0
};

inline RangeGrid slab_with_pins(const std::vector<SlabPin>& pins, const Slab& slab) {
  RangeGrid grid;
  grid.allocate(slab.rows, slab.cols);
  grid.spacing_mm = slab.spacing_mm;
  Random random(slab.seed);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const double x = slab.spacing_mm * (col - grid.cols / 2);
      const double y = slab.spacing_mm * (row - grid.rows / 2);
      double z = slab.clay && std::abs(x) < 15 && std::abs(y) < 12 ? 0.0 : -1000.0;
      for (const SlabPin& pin : pins) {
        const double dx = x - pin.tip_mm.x();
        const double dy = y - pin.tip_mm.y();
        const double r = pin.radius_mm;
        if (pin.ball && dx * dx + dy * dy < r * r) {
          z = std::max(z, pin.tip_mm.z() + std::sqrt(r * r - dx * dx - dy * dy));
        }
        const double arm = r + 0.04 * dx;
        if (dx > 0 && dx < pin.length_mm && std::abs(dy) < arm) {
          z = std::max(z, pin.tip_mm.z() + std::sqrt(arm * arm - dy * dy));
        }
      }
      const double noise = slab.noise_mm * random.normal();
      if (z > -500) {
        const std::size_t i = grid.index(row, col);
        grid.x[i] = static_cast<float>(x);
        grid.y[i] = static_cast<float>(y);
        grid.z[i] = static_cast<float>(z + noise);
        grid.valid[i] = 1;
      }
    }
  }
  return grid;
}

}  // namespace dubsar::testing
