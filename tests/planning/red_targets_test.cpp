// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/range_grid.h"
#include "planning/sparse_flags.h"

namespace dubsar {
namespace {

/// What is red in and around a square hole of 4 mm, in a nearly flat piece of 8 mm that was scanned at this
/// spacing.
double area_of_hole_mm2(double spacing_mm) {
  RangeGrid grid;
  const int side = static_cast<int>(8.0 / spacing_mm);
  grid.allocate(side, side);
  grid.spacing_mm = spacing_mm;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>((col + 0.5) * spacing_mm - 4.0);
      grid.y[i] = static_cast<float>((row + 0.5) * spacing_mm - 4.0);
      grid.z[i] = -0.01F * grid.y[i] * grid.y[i];
      grid.valid[i] = std::max(std::abs(grid.x[i]), std::abs(grid.y[i])) > 2.0F;
    }
  }
  const SampleFlags flags = flag_sparse(grid);
  const PlacedScan scan{0, &grid, &flags, RigidTransform{}, 0.0};
  const RedTargets red = red_targets({&scan, 1}, model_surface({&scan, 1}));
  double area_mm2 = 0;
  for (const RedTarget& target : red.targets) {
    const bool is_there = !target.unseen && target.position_mm.cwiseAbs().maxCoeff() < 3;
    area_mm2 += is_there ? target.area_mm2 : 0.0;
  }
  return area_mm2;
}

TEST(RedTargets, TheRimsOfAHoleAddUpToItAtEverySpacing) {
  EXPECT_NEAR(area_of_hole_mm2(0.1), 16, 1.5);
  EXPECT_NEAR(area_of_hole_mm2(0.05), 16, 1.5) << "80 samples across";
}

}  // namespace
}  // namespace dubsar
