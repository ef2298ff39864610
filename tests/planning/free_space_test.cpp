// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/free_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planning/model_surface.h"

namespace dubsar {
namespace {

constexpr double kHalfMm = 20.0;
constexpr double kWallMm = 12.0;

/// A floor between two walls that run along x, from above.
double floor_between_walls(double y_mm) {
  return kWallMm * std::clamp((std::abs(y_mm) - 8.0) / 2.0, 0.0, 1.0);
}

class FreeSpaceTest : public ::testing::Test {
 protected:
  FreeSpaceTest() {
    constexpr double kSpacingMm = 0.25;
    const int side = static_cast<int>(2 * kHalfMm / kSpacingMm) + 1;
    grid_.allocate(side, side);
    grid_.spacing_mm = kSpacingMm;
    for (int row = 0; row < side; ++row) {
      for (int col = 0; col < side; ++col) {
        const std::size_t i = grid_.index(row, col);
        grid_.x[i] = static_cast<float>(-kHalfMm + col * kSpacingMm);
        grid_.y[i] = static_cast<float>(kHalfMm - row * kSpacingMm);
        grid_.z[i] = static_cast<float>(floor_between_walls(grid_.y[i]));
        grid_.valid[i] = 1;
      }
    }
    flags_.assign(grid_.size(), 0);
    scan_.id = 1;
    scan_.grid = &grid_;
    scan_.flags = &flags_;
  }

  RangeGrid grid_;
  SampleFlags flags_;
  PlacedScan scan_;
};

TEST_F(FreeSpaceTest, IsWhatLinesOfSightCross) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-20, -20, -10), Eigen::Vector3d(20, 20, 14));
  const FreeSpace air({&scan_, 1}, box, 0.5);
  for (const double x : {-19.0, 0.3, 15.0}) {
    EXPECT_TRUE(air.was_looked_through({x, 0.2, 1.8}));
    EXPECT_TRUE(air.was_looked_through({x, -5, 11}));
    EXPECT_TRUE(air.was_looked_through({x, 14, 13.5}));
    EXPECT_FALSE(air.was_looked_through({x, 0.2, 0})) << "the floor itself";
    EXPECT_FALSE(air.was_looked_through({x, 0.2, -5})) << "below the floor";
    EXPECT_FALSE(air.was_looked_through({x, 14, 6})) << "in the wall";
  }
  EXPECT_FALSE(air.was_looked_through({0, 0, 20})) << "outside the box";
  flags_.assign(flags_.size(), kSparse);
  EXPECT_FALSE(FreeSpace({&scan_, 1}, box, 0.5).was_looked_through({0, 0.2, 5})) << "of no sound sample";
}

/// The hull closes the ends of the channel, through which nothing is met.
TEST_F(FreeSpaceTest, NoSurfaceIsMissingWhereTheHullSpansAHollowThatWasLookedThrough) {
  const ModelSurface surface = model_surface({&scan_, 1});
  const auto unseen_at_an_end = [&](double low_y, double high_y, double low_z, double high_z) {
    return std::ranges::count_if(surface.unseen, [&](const SurfacePatch& patch) {
      const Eigen::Vector3d& p = patch.position_mm;
      return std::abs(p.x()) > kHalfMm - 1 && std::abs(p.y()) > low_y && std::abs(p.y()) < high_y &&
             p.z() > low_z && p.z() < high_z;
    });
  };
  EXPECT_EQ(unseen_at_an_end(0, 6, 3, 10), 0) << "the channel";
  EXPECT_GT(unseen_at_an_end(12, 18, 2, 10), 10) << "the walls' ends, which nobody saw";
  EXPECT_GT(std::ranges::count_if(surface.unseen, [](const SurfacePatch& p) { return p.normal.z() < -0.9; }),
            100)
      << "the other side of the floor";
}

}  // namespace
}  // namespace dubsar
