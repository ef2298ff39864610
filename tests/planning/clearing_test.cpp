// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "core/units.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"

namespace dubsar {
namespace {

/// A flat patch at z = height_mm, x from left_mm on.
RangeGrid patch(int rows, int cols, double left_mm, double height_mm = 0.0) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  grid.spacing_mm = 0.1;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const std::size_t i = grid.index(r, c);
      grid.x[i] = static_cast<float>(left_mm + 0.1 * c);
      grid.y[i] = static_cast<float>(0.1 * r);
      grid.z[i] = static_cast<float>(height_mm);
      grid.valid[i] = 1;
    }
  }
  return grid;
}

struct Scan {
  explicit Scan(RangeGrid g) : grid(std::move(g)), flags(flag_sparse(grid)) {}
  [[nodiscard]] PlacedScan placed(int id, const RigidTransform& pose = {}, double sigma_mm = 0.0) const {
    return {id, &grid, &flags, pose, sigma_mm};
  }
  RangeGrid grid;
  SampleFlags flags;
};

bool red_at(const ClearedMap& map, int id, const RangeGrid& grid, int row, int col) {
  return is_red((*map.flags(id))[grid.index(row, col)]);
}

TEST(Clearing, OverlappingScansClearEachOthersBorderBothWays) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 2.0));
  ClearedMap map;
  map.add(a.placed(0));
  EXPECT_TRUE(red_at(map, 0, a.grid, 15, 39));
  map.add(b.placed(1));
  EXPECT_FALSE(red_at(map, 0, a.grid, 15, 39));
  EXPECT_FALSE(red_at(map, 1, b.grid, 15, 0));
  EXPECT_TRUE(red_at(map, 0, a.grid, 15, 0));
  EXPECT_TRUE(red_at(map, 1, b.grid, 15, 39));
  EXPECT_EQ(map.cleared_by(0)[a.grid.index(15, 39)], 1);
  EXPECT_EQ(map.cleared_by(0)[a.grid.index(15, 0)], -1);
}

TEST(Clearing, FlaggedSamplesClearNothing) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 3.9));  // only the red borders coincide
  ClearedMap map;
  map.add(a.placed(0));
  map.add(b.placed(1));
  // 0.1 mm beside a's border lies b's first unflagged column: within 2µ, so both borders clear.
  EXPECT_FALSE(red_at(map, 0, a.grid, 15, 39));
  const Scan c(patch(30, 1, 3.9));  // one column: all of it red
  ClearedMap lone;
  lone.add(a.placed(0));
  lone.add(c.placed(1));
  EXPECT_TRUE(red_at(lone, 0, a.grid, 15, 39));
}

TEST(Clearing, AGapOfThreeSpacingsStaysRed) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 3.9 + 0.3));
  ClearedMap map;
  map.add(a.placed(0));
  map.add(b.placed(1));
  EXPECT_TRUE(red_at(map, 0, a.grid, 15, 39));
  EXPECT_TRUE(red_at(map, 1, b.grid, 15, 0));
}

TEST(Clearing, AnUncertainPoseWidensTheMatchButOnlySoFar) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 3.9 + 0.3));
  ClearedMap map;
  map.add(a.placed(0));
  map.add(b.placed(1, {}, 0.1));
  EXPECT_FALSE(red_at(map, 0, a.grid, 15, 39));
  const Scan far(patch(30, 40, 3.9 + 0.8));
  ClearedMap lost;
  lost.add(a.placed(0));
  lost.add(far.placed(1, {}, 5.0));
  EXPECT_TRUE(red_at(lost, 0, a.grid, 15, 39));
}

TEST(Clearing, TheOtherSideOfAThinRimDoesNotClear) {
  const Scan above(patch(30, 40, 0.0));
  const Scan below(patch(30, 40, -1.0));
  // Seen from beneath, 0.1 mm below the first sheet: turned about the y axis.
  RigidTransform from_below;
  from_below.rotation = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  from_below.translation_mm = {4.0, 0.0, -0.1};
  ClearedMap map;
  map.add(above.placed(0));
  map.add(below.placed(1, from_below));
  EXPECT_TRUE(red_at(map, 0, above.grid, 15, 39));
  ClearingOptions no_normals;
  no_normals.max_normal_angle_rad = kPi;
  ClearedMap blind(no_normals);
  blind.add(above.placed(0));
  blind.add(below.placed(1, from_below));
  EXPECT_FALSE(red_at(blind, 0, above.grid, 15, 39));
}

TEST(Clearing, TheMapDoesNotDependOnTheWayThere) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 2.0));
  const Scan c(patch(30, 40, 4.5));
  RigidTransform moved;
  moved.translation_mm = {0.0, 1.0, 0.0};
  ClearedMap straight;
  straight.add(a.placed(0));
  straight.add(b.placed(1, moved));
  straight.add(c.placed(2));
  ClearedMap winding;
  winding.add(c.placed(2));
  winding.add(b.placed(1));
  winding.add(a.placed(7));
  winding.add(a.placed(0));
  winding.remove(7);
  winding.remove(99);
  winding.reposition(1, moved, 0.0);
  for (const int id : {0, 1, 2}) {
    EXPECT_EQ(*straight.flags(id), *winding.flags(id)) << id;
  }
  winding.remove(1);
  ClearedMap without;
  without.add(a.placed(0));
  without.add(c.placed(2));
  EXPECT_EQ(*winding.flags(0), *without.flags(0));
  EXPECT_EQ(winding.scans().size(), 2U);
  EXPECT_FALSE(winding.contains(1));
}

TEST(Clearing, PairwiseStepAgreesWithTheMap) {
  const Scan a(patch(30, 40, 0.0));
  const Scan b(patch(30, 40, 2.0));
  SampleFlags flags = a.flags;
  const std::int64_t cleared = clear_against(a.placed(0), b.placed(1), flags);
  EXPECT_GT(cleared, 30);
  ClearedMap map;
  map.add(a.placed(0));
  map.add(b.placed(1));
  EXPECT_EQ(flags, *map.flags(0));
}

TEST(Clearing, EmptyAndInvalidScansAreHarmless) {
  const Scan empty{RangeGrid{}};
  RangeGrid lost_grid = patch(5, 5, 0.0);
  std::fill(lost_grid.valid.begin(), lost_grid.valid.end(), std::uint8_t{0});
  const Scan lost(lost_grid);
  const Scan a(patch(30, 40, 0.0));
  ClearedMap map;
  map.add(empty.placed(0));
  map.add(lost.placed(1));
  map.add(a.placed(2));
  EXPECT_TRUE(red_at(map, 2, a.grid, 15, 0));
}

}  // namespace
}  // namespace dubsar
