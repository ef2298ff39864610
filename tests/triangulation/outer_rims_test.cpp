// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/outer_rims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

constexpr double kMu = 0.1;

Mesh stitched(RangeGrid grid) {
  test::ScanSet set;
  set.add(std::move(grid), {});
  JobContext job;
  return stitch(set.placed, {}, job).value();
}

RangeGrid rough_plane(int rows, int cols) {
  Random random(5);
  return test::height_grid(rows, cols, kMu, [&](double, double) { return 0.05 * kMu * random.normal(); });
}

TEST(OuterRims, SmallPiecesBesideALargeOneAreKeptWhole) {
  const struct {
    int rows, cols;
  } kPieces[] = {{8, 8}, {10, 10}, {3, 30}, {4, 100}, {5, 30}, {7, 20}, {12, 12}};
  for (const auto& piece : kPieces) {
    RangeGrid grid = rough_plane(60, 180);
    std::size_t samples = 0;
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        const bool small = row >= 20 && row < 20 + piece.rows && col >= 76 && col < 76 + piece.cols;
        grid.valid[grid.index(row, col)] = small || col < 60 ? 1 : 0;
        samples += small || col < 60 ? 1 : 0;
      }
    }
    const Mesh mesh = stitched(grid);
    EXPECT_EQ(mesh.positions.size(), samples) << piece.rows << " x " << piece.cols;
    EXPECT_EQ(check_mesh(mesh).components, 2U);
  }
}

/// A hole whose walls are too steep to be seen: its floor is a piece of its own.
TEST(OuterRims, TheFloorOfAHoleIsKept) {
  for (const double across : {8.0, 12.0, 14.0}) {
    RangeGrid grid = rough_plane(40, 40);
    std::size_t floor = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double r = std::hypot(grid.x[i], grid.y[i]) / kMu;
      if (r < across / 2) {
        grid.z[i] -= 3;
        ++floor;
      } else if (r < across / 2 + 0.5) {
        grid.valid[i] = 0;
      }
    }
    const Mesh mesh = stitched(grid);
    const auto kept = std::ranges::count_if(mesh.positions, [](const auto& p) { return p.z() < -2; });
    EXPECT_EQ(static_cast<std::size_t>(kept), floor) << across;
  }
}

TEST(OuterRims, TheRimOfAnOpeningIsNone) {
  RangeGrid grid = rough_plane(30, 30);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = std::abs(grid.x[i]) < kMu && std::abs(grid.y[i]) < 2.1 * kMu ? 0 : 1;
  }
  EXPECT_EQ(check_mesh(stitched(grid)).boundary_loops, 1U);
}

}  // namespace
}  // namespace dubsar
