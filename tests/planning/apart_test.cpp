// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/apart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "planning/red_map.h"
#include "planning/sample_states.h"
#include "planning/sparse_flags.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using test::kSpacingMm;
using test::Session;
using test::turned;

/// Adds a scan of `grid`, taken from straight above, as it is.
void add(RangeGrid grid, const RigidTransform& pose, Session& session) {
  session.grids.push_back(std::make_unique<RangeGrid>(std::move(grid)));
  const SampleFlags flags = flag_sparse(*session.grids.back());
  session.map.add(
      {static_cast<int>(session.grids.size()) - 1, session.grids.back().get(), &flags, pose, 0.0});
}

void scan_all_sides(Session& session) {
  for (const double x : {0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0}) {
    session.scan(turned(x, 0));
  }
  for (const double y : {45.0, 90.0, 135.0, 225.0, 270.0, 315.0}) {
    session.scan(turned(0, y));
  }
}

/// A level strip in the air, seen from above.
RangeGrid strip(const Eigen::Vector2d& low_mm, const Eigen::Vector2d& high_mm, double z_mm) {
  RangeGrid grid = test::scan_pebble({});
  grid.valid.assign(grid.size(), 0);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.cols; ++c) {
      const Eigen::Vector2d p((c - 55) * kSpacingMm, (r - 55) * kSpacingMm);
      if ((p.array() >= low_mm.array()).all() && (p.array() <= high_mm.array()).all()) {
        const std::size_t i = grid.index(r, c);
        grid.x[i] = static_cast<float>(p.x());
        grid.y[i] = static_cast<float>(p.y());
        grid.z[i] = static_cast<float>(z_mm);
        grid.valid[i] = 1;
      }
    }
  }
  return grid;
}

/// Red targets in a row, from `p` on.
void add_red(const Eigen::Vector3d& p_mm, int count, RedTargets& red) {
  red.cell_mm = 0.75;
  for (int k = 0; k < count; ++k) {
    RedTarget target;
    target.position_mm = target.sample_mm = p_mm + Eigen::Vector3d(0.5 * k, 0, 0);
    target.area_mm2 = 0.1;
    red.targets.push_back(target);
  }
}

/// Where a hole of the cover lies that is one of what hangs apart.
std::vector<Eigen::Vector3d> holes_apart(const SurfaceCover& cover, const std::vector<std::uint8_t>& apart) {
  std::vector<Eigen::Vector3d> out;
  for (std::size_t h = 0; h < apart.size(); ++h) {
    if (apart[h] != 0) {
      out.push_back(cover.rims()[cover.holes()[h].rim.front()].position_mm);
    }
  }
  return out;
}

TEST(Apart, WhatHangsBesideAClosedTabletIsNotRed) {
  Session session;
  scan_all_sides(session);
  // Where no other scan has the pebble behind it.
  add(strip({12.3, 9.3}, {13.4, 13.4}, 0), {}, session);
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->map.conclusive);
  EXPECT_TRUE(result->map.next.empty());
  int strays = 0;
  for (const RedTarget& target : result->targets.targets) {
    EXPECT_NE(target.state, RegionState::kRed) << target.position_mm.transpose();
    strays += is_stray(target) && target.sample_mm.y() > 9.2 ? 1 : 0;
  }
  EXPECT_GT(strays, 5);
  // 4 x 16 samples: the 36 of the border, and those diagonally inside its corners.
  const RedScan& of_strip = result->map.scans.back();
  ASSERT_EQ(of_strip.id, static_cast<int>(session.grids.size()) - 1);
  EXPECT_EQ(of_strip.samples, 64);
  EXPECT_EQ(of_strip.potentially_sparse, 36);
  EXPECT_EQ(of_strip.sparse, 0);
  EXPECT_EQ(of_strip.cleared, 0);
  EXPECT_EQ(of_strip.excused, 40);
}

TEST(Apart, NearAHoleItMayBeClay) {
  Session session;
  session.pit_mm = 0.8;
  scan_all_sides(session);
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  RedTargets red;
  add_red({0, 0, 11}, 5, red);
  add_red({0, 0, -11}, 5, red);
  EXPECT_TRUE(holes_apart(cover, excuse_apart(scans, cover, red)).empty());
  for (std::size_t i = 0; i < red.targets.size(); ++i) {
    const RedTarget& target = red.targets[i];
    EXPECT_EQ(target.state, i < 5 ? RegionState::kRed : RegionState::kExcused);
    EXPECT_EQ(is_stray(target), i >= 5);
  }
}

TEST(Apart, NearRedThatTheCoverDoesNotShowItMayBeClay) {
  Session session;
  scan_all_sides(session);
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  RedTargets red;
  add_red({0, 0, 5}, 4, red);
  add_red({0, 0, 9}, 5, red);
  add_red({0, 0, -11}, 5, red);
  (void)excuse_apart(scans, cover, red);
  for (std::size_t i = 0; i < red.targets.size(); ++i) {
    EXPECT_EQ(red.targets[i].state, i < 9 ? RegionState::kRed : RegionState::kExcused) << i;
  }
}

TEST(Apart, ALargeBorderExcusesNothing) {
  // The front, and a little of the back: nothing between them was seen.
  Session session;
  session.scan(turned(0, 0));
  session.half_field_mm = 1.0;
  session.scan(turned(180, 0));
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  ASSERT_EQ(cover.parts().size(), 2U);
  ASSERT_LT(50 * cover.parts()[1], cover.parts()[0]) << "else it counted as a second body";
  RedTargets red = red_targets(scans, model_surface(scans));
  add_red({0, 0, -40}, 5, red);
  EXPECT_TRUE(holes_apart(cover, excuse_apart(scans, cover, red)).empty());
  for (const RedTarget& target : red.targets) {
    EXPECT_EQ(target.state, RegionState::kRed) << target.position_mm.transpose();
  }
}

TEST(Apart, WhatHangsOnAPieceThatMayBeClayMayBeClay) {
  Session session;
  session.pit_mm = 0.8;
  scan_all_sides(session);
  add(strip({-1, -1}, {1, 1}, 14), {}, session);
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  RedTargets red;
  add_red({0, 0, 20}, 5, red);
  EXPECT_TRUE(holes_apart(cover, excuse_apart(scans, cover, red)).empty());
  for (const RedTarget& target : red.targets) {
    EXPECT_EQ(target.state, RegionState::kRed);
  }
}

TEST(Apart, ASecondBodyIsNoStray) {
  Session session;
  scan_all_sides(session);
  RigidTransform beside = turned(0, 0);
  beside.translation_mm.x() = 60;
  add(test::scan_pebble({}), beside, session);
  RigidTransform arm = turned(0, 0);
  arm.translation_mm.x() = -140;
  add(strip({-3, -0.7}, {3, 0.7}, 0), arm, session);
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  ASSERT_EQ(cover.parts().size(), 3U);
  RedTargets red = red_targets(scans, model_surface(scans));
  const auto holes = holes_apart(cover, excuse_apart(scans, cover, red));
  EXPECT_FALSE(holes.empty());
  for (const Eigen::Vector3d& p : holes) {
    EXPECT_LT(p.x(), -130);
  }
  int second = 0;
  for (const RedTarget& target : red.targets) {
    EXPECT_EQ(is_stray(target), !target.unseen && target.sample_mm.x() < -130);
    second += target.state == RegionState::kRed && target.sample_mm.x() > 40 ? 1 : 0;
  }
  EXPECT_GT(second, 20);
}

TEST(Apart, AChipBesideTheTabletIsToldWithItsSize) {
  Session session;
  scan_all_sides(session);
  RigidTransform beside = turned(0, 0);
  beside.translation_mm.x() = -140;
  add(strip({-2.5, -2.5}, {2.5, 2.5}, 0), beside, session);
  const auto scans = session.map.scans();
  const SurfaceCover cover(scans);
  ASSERT_EQ(cover.parts().size(), 2U);
  ASSERT_LT(50 * cover.parts()[1], cover.parts()[0]) << "else it counted as a second body";
  RedTargets red = red_targets(scans, model_surface(scans));
  (void)excuse_apart(scans, cover, red);
  double of_chip_mm2 = 0;
  double seen_mm2 = 0;
  for (const RedTarget& target : red.targets) {
    if (!target.unseen && target.sample_mm.x() < -130) {
      EXPECT_EQ(target.state, RegionState::kExcused);
      EXPECT_FALSE(is_stray(target));
      const std::string before = "which is closed there: at least ";
      ASSERT_NE(target.reason.find(before), std::string::npos) << target.reason;
      seen_mm2 = std::stod(target.reason.substr(target.reason.find(before) + before.size()));
      of_chip_mm2 += target.area_mm2;
    }
  }
  EXPECT_GT(of_chip_mm2, 1);
  EXPECT_LE(seen_mm2, 25);
  EXPECT_GE(seen_mm2, 12);
}

}  // namespace
}  // namespace dubsar
