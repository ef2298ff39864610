// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_geometry.h"

#include <gtest/gtest.h>

#include "tests/support/height_field.h"

namespace dubsar {
namespace {

TEST(GridGeometry, NormalOfATiltedPlanePointsToTheCamera) {
  const RangeGrid grid = test::height_field(9, 9, 0.1, [](double x, double y) { return 0.5 * x - 0.25 * y; });
  const GridGeometry geometry = grid_geometry(grid);
  const Eigen::Vector3f expected = Eigen::Vector3f(-0.5F, 0.25F, 1.0F).normalized();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_LT((geometry.normals[i] - expected).norm(), 1e-4F) << i;
  }
}

TEST(GridGeometry, NormalTurnsRoundWithTheView) {
  RangeGrid grid = test::height_field(5, 5, 0.1, [](double, double) { return 0.0; });
  grid.view.direction = {0, 0, 1};
  EXPECT_LT(grid_geometry(grid).normals[12].z(), -0.99F);
  grid.view.camera_mm = Eigen::Vector3d(0, 0, 100);  // a known position outweighs the direction
  EXPECT_GT(grid_geometry(grid).normals[12].z(), 0.99F);
}

TEST(GridGeometry, BoundaryAtBorderHoleAndStep) {
  RangeGrid grid = test::height_field(9, 9, 0.1, [](double x, double) { return x > 0.05 ? 5.0 : 0.0; });
  grid.valid[grid.index(4, 2)] = 0;
  const GridGeometry geometry = grid_geometry(grid);
  EXPECT_EQ(geometry.boundary[grid.index(0, 1)], 1);  // border of the grid
  EXPECT_EQ(geometry.boundary[grid.index(4, 1)], 1);  // beside the hole
  EXPECT_EQ(geometry.boundary[grid.index(4, 2)], 0);  // the hole itself is no sample
  EXPECT_EQ(geometry.boundary[grid.index(4, 4)], 1);  // below the step
  EXPECT_EQ(geometry.boundary[grid.index(4, 5)], 1);  // above the step
  EXPECT_EQ(geometry.boundary[grid.index(2, 2)], 0);
  // The one-sided difference beside the step does not tilt the normal.
  EXPECT_GT(geometry.normals[grid.index(4, 4)].z(), 0.999F);
}

}  // namespace
}  // namespace dubsar
