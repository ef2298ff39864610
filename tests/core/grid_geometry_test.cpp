// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

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

/// Bumps, a step, drop-outs and what is not a number.
RangeGrid rough_grid(int rows, int cols) {
  RangeGrid grid;
  grid.rows = rows;
  grid.cols = cols;
  grid.spacing_mm = 0.1;
  std::uint32_t noise = 1;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      noise = noise * 1664525U + 1013904223U;
      const float height = static_cast<float>(noise >> 8U) * 0x1p-24F;
      grid.x.push_back(0.1F * static_cast<float>(col));
      grid.y.push_back(0.1F * static_cast<float>(row));
      grid.z.push_back(noise % 97U == 0 ? std::numeric_limits<float>::quiet_NaN()
                                        : 0.1F * height + (col > 70 ? 2.0F : 0.0F));
      grid.valid.push_back(noise % 11U != 0 ? 1 : 0);
    }
  }
  grid.view.camera_mm = Eigen::Vector3d(1, 2, 100);
  grid.view.motion_per_row_mm = {0, 0.1, 0};
  return grid;
}

TEST(GridGeometry, TheSameForEveryPartOfARowHoweverWideTheGrid) {
  const RangeGrid whole = rough_grid(5, 200);
  const GridGeometry all = grid_geometry(whole);
  EXPECT_GT(std::ranges::count_if(all.normals, [](const auto& n) { return n.norm() > 0.99F; }), 600);
  for (const int cols : {1, 2, 63, 64, 65, 66, 128, 130, 199}) {
    for (const int from : {0, 1, 40}) {
      if (from + cols > whole.cols) {
        continue;
      }
      RangeGrid part = whole;
      part.cols = cols;
      for (auto* values : {&part.x, &part.y, &part.z}) {
        values->clear();
      }
      part.valid.clear();
      for (int row = 0; row < whole.rows; ++row) {
        for (int col = from; col < from + cols; ++col) {
          const std::size_t i = whole.index(row, col);
          part.x.push_back(whole.x[i]);
          part.y.push_back(whole.y[i]);
          part.z.push_back(whole.z[i]);
          part.valid.push_back(whole.valid[i]);
        }
      }
      const GridGeometry there = grid_geometry(part);
      for (int row = 0; row < whole.rows; ++row) {
        for (int col = 1; col + 1 < cols; ++col) {  // at either end the part has one neighbour less
          const std::size_t i = whole.index(row, from + col);
          const std::size_t k = part.index(row, col);
          ASSERT_EQ(there.normals[k], all.normals[i])
              << cols << " from " << from << ": " << row << ", " << col;
          ASSERT_EQ(there.boundary[k], all.boundary[i]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace dubsar
