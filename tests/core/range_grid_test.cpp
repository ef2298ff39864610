// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/range_grid.h"

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "core/random.h"
#include "tests/support/height_field.h"

namespace dubsar {
namespace {

TEST(RangeGrid, AllocatedCellsAreInvalid) {
  RangeGrid grid;
  grid.allocate(3, 4);
  EXPECT_EQ(grid.size(), 12U);
  EXPECT_EQ(grid.valid_count(), 0U);
  EXPECT_FALSE(grid.is_valid(-1, 0));
  EXPECT_FALSE(grid.is_valid(0, 4));
}

TEST(RangeGrid, SpacingIsLateralAndTheLargerOfTheTwoDirections) {
  RangeGrid grid = test::height_field(30, 30, 0.1, [](double x, double) { return 3 * x; });
  grid.spacing_mm = 0;
  EXPECT_NEAR(estimate_spacing_mm(grid), 0.1, 1e-5);  // the slope does not count
  for (float& y : grid.y) {
    y *= 2;
  }
  EXPECT_NEAR(estimate_spacing_mm(grid), 0.2, 1e-5);
  EXPECT_EQ(estimate_spacing_mm(RangeGrid{}), 0.0);
}

TEST(RangeGrid, DecimationKeepsMeasuredSamples) {
  RangeGrid grid = test::height_field(7, 10, 0.1, [](double x, double y) { return x * y; });
  grid.view.motion_per_row_mm = {0, 0.1, 0};
  const RangeGrid small = decimated(grid, 3);
  EXPECT_EQ(small.rows, 3);
  EXPECT_EQ(small.cols, 4);
  EXPECT_NEAR(small.spacing_mm, 0.3, 1e-12);
  EXPECT_NEAR(small.view.motion_per_row_mm.y(), 0.3, 1e-12);
  EXPECT_EQ(small.point(small.index(2, 3)), grid.point(grid.index(6, 9)));
}

TEST(ScannerView, MovesWithTheRows) {
  ScannerView view;
  EXPECT_EQ(view.to_camera({5, 5, 5}, 3), Eigen::Vector3d(0, 0, 1));
  view.camera_mm = Eigen::Vector3d(0, 0, 100);
  view.motion_per_row_mm = {0, 1, 0};
  EXPECT_LT((view.to_camera({0, 7, 0}, 7) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
}

TEST(Parallel, OrderedReductionEqualsTheSerialSum) {
  Random random(5);
  std::vector<double> values(10007);
  for (double& v : values) {
    v = random.normal() * 1e6;
  }
  const auto map = [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      sum += values[i];
    }
    return sum;
  };
  double serial = 0;
  for (std::size_t begin = 0; begin < values.size(); begin += 64) {
    serial += map(begin, std::min(begin + 64, values.size()));
  }
  const double parallel =
      parallel_reduce_ordered(values.size(), 64, 0.0, map, [](double& into, double part) { into += part; });
  EXPECT_EQ(parallel, serial);  // to the last bit
}

}  // namespace
}  // namespace dubsar
