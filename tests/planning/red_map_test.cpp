// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/units.h"
#include "planning/checklist.h"
#include "planning/cleared_map.h"
#include "planning/excuse.h"
#include "planning/next_view.h"
#include "planning/red_change.h"
#include "planning/red_regions.h"
#include "planning/sparse_flags.h"
#include "planning/view_prediction.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using test::Session;
using test::turned;
using test::turntable_rig;

double area_on(const RedMap& map, Face face) {
  double area = 0;
  for (const RedRegion& r : map.regions) {
    area += r.face == face ? r.area_mm2 : 0.0;
  }
  return area;
}

TEST(RedMap, NothingScannedIsNotConclusive) {
  JobContext job;
  const auto result = make_red_map({}, nullptr, nullptr, {}, job);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->map.conclusive);
}

TEST(RedMap, TheWallOfAWedgeIsOnTheSideThatTheWedgeIsOn) {
  ModelSurface surface{MeshQuery(Mesh()), {}, 0.0, {0, 0, 0}, {}, {}, {}, {}};
  for (double x = -5; x <= 5; x += 1) {
    surface.seen.push_back({{x, 0, 10}, {0, 0, 1}, 1.0});
    surface.unseen.push_back({{x, 0, -10}, {0, 0, -1}, 1.0});
  }
  RedTargets red;
  RedTarget wall;
  wall.position_mm = {0.3, 0, 9.4};
  wall.normal = {0.9, 0, 0.43};  // looks to the right
  wall.area_mm2 = 0.1;
  red.targets.push_back(wall);
  red.cell_mm = 0.3;
  const std::vector<RedRegion> regions = red_regions(red, {}, surface);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].face, Face::kObverse);
  EXPECT_LT((regions[0].normal - wall.normal.normalized()).norm(), 1e-9);
}

TEST(RedMap, APlaceThatGoesRoundAnEdgeIsToldByItsSides) {
  // Forty patches of the reverse, seven of the bottom edge and one of the right one, side by side.
  ModelSurface surface{MeshQuery(Mesh()), {}, 0.0, {0, 0, 0}, {}, {}, {}, {}};
  RedTargets red;
  red.cell_mm = 1.0;
  const auto add = [&](const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
    surface.unseen.push_back({position, normal, 2.0});
    RedTarget target;
    target.position_mm = position;
    target.normal = normal;
    target.area_mm2 = 2.0;
    target.unseen = true;
    red.targets.push_back(target);
  };
  for (int i = 0; i < 40; ++i) {
    add({1.0 * (i % 8), 1.0 * (i / 8), -5}, {0, 0, -1});
  }
  for (int i = 0; i < 7; ++i) {
    add({1.0 * i, -0.7, -4.3}, {0, -1, -0.1});
  }
  add({7.7, 0, -4.3}, {1, 0, 0});
  const std::vector<RedRegion> regions = red_regions(red, {}, surface);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].face, Face::kReverse);
  EXPECT_NEAR(regions[0].area_mm2, 82.0, 1e-9);  // with the scrap of the right edge
  EXPECT_EQ(regions[1].face, Face::kBottom);
  EXPECT_NEAR(regions[1].area_mm2, 14.0, 1e-9);
}

TEST(RedMap, AllOfALargePlaceSaysWhichSideItIsOn) {
  // Of every sixteenth patch, all that once were asked, each faces the bottom edge.
  ModelSurface surface{MeshQuery(Mesh()), {}, 0.0, {0, 0, 0}, {}, {}, {}, {}};
  RedTargets red;
  red.cell_mm = 1.0;
  for (int i = 0; i < 256; ++i) {
    const Eigen::Vector3d normal = i % 16 == 0 ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(0, 0, -1);
    RedTarget target;
    target.position_mm = {0.5 * (i % 16), 0.5 * (i / 16), -5};
    target.normal = normal;
    target.area_mm2 = 0.06;
    target.unseen = true;
    red.targets.push_back(target);
    surface.unseen.push_back({target.position_mm, normal, 0.06});
  }
  const std::vector<RedRegion> regions = red_regions(red, {}, surface);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].face, Face::kReverse);
}

TEST(RedMap, TheUnseenUndersideIsOneLargeRegionOfTheReverse) {
  Session session;
  session.scan(turned(0, 0));
  JobContext job;
  const Rig rig = turntable_rig();
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(result);
  ASSERT_FALSE(result->map.regions.empty());
  EXPECT_FALSE(result->map.conclusive);
  // The silhouette that closes the first scan encloses pi · 12 · 9 = 339 mm², less the grazing rim.
  EXPECT_GT(area_on(result->map, Face::kReverse), 200.0);
  EXPECT_LT(area_on(result->map, Face::kReverse), 450.0);
  EXPECT_EQ(result->map.regions.front().face, Face::kReverse);
  EXPECT_LT(result->map.regions.front().normal.z(), -0.8);
  ASSERT_FALSE(result->map.next.empty());
  EXPECT_GT(result->map.next.front().predicted_cleared_mm2, 10.0);
  EXPECT_TRUE(result->map.next.front().placement.has_value());
}

TEST(RedMap, WhatAScanClearsIsMeasuredOnTheRedThatWasThere) {
  Session session;
  session.scan(turned(0, 0));
  JobContext job;
  const auto before = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_TRUE(before);
  double red = 0;
  for (const RedTarget& t : before->targets.targets) {
    red += t.state == RegionState::kRed ? t.area_mm2 : 0.0;
  }
  EXPECT_LT(cleared_area_mm2(before->targets, session.map.scans().back()), 0.05 * red)
      << "the scan that left the red clears nothing of it";
  session.scan(turned(180, 0));
  const double cleared = cleared_area_mm2(before->targets, session.map.scans().back());
  EXPECT_GT(cleared, 0.5 * red) << "the other side is what was missing";
  EXPECT_LE(cleared, red);

  // A scan from there was predicted to.
  ViewCandidate view;
  view.model_from_scanner = turned(180, 0);
  double predicted = 0;
  const PlacedScan only[] = {session.map.scans().front()};
  const std::vector<double> chances = clearing_chances(view, ScannerModel::of(*session.grids.back(), 0.0),
                                                       model_surface(only), before->targets.targets);
  for (std::size_t i = 0; i < chances.size(); ++i) {
    predicted += chances[i] * before->targets.targets[i].area_mm2;
  }
  EXPECT_NEAR(predicted, cleared, 0.3 * cleared);
}

TEST(RedMap, AnObjectSeenFromAllSidesIsConclusive) {
  Session session;
  for (const double x : {0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0}) {
    session.scan(turned(x, 0));
  }
  for (const double y : {45.0, 90.0, 135.0, 225.0, 270.0, 315.0}) {
    session.scan(turned(0, y));
  }
  JobContext job;
  const Rig rig = turntable_rig();
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->map.conclusive);
  EXPECT_TRUE(result->map.next.empty());
  ASSERT_EQ(result->map.scans.size(), session.grids.size());
  for (const RedScan& scan : result->map.scans) {
    EXPECT_EQ(scan.sparse, 0);
    EXPECT_GT(scan.cleared, 0);
  }
}

TEST(RedMap, SameInputSameResult) {
  Session session;
  session.scan(turned(0, 0));
  session.scan(turned(60, 0));
  JobContext job;
  const Rig rig = turntable_rig();
  const auto a = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  const auto b = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->flags, b->flags);
  ASSERT_EQ(a->map.next.size(), b->map.next.size());
  for (std::size_t k = 0; k < a->map.next.size(); ++k) {
    EXPECT_EQ(a->map.next[k].predicted_cleared_mm2, b->map.next[k].predicted_cleared_mm2);
    EXPECT_EQ(a->map.next[k].model_from_scanner.row_major(), b->map.next[k].model_from_scanner.row_major());
  }
}

TEST(RedMap, WithoutARigNothingIsOutOfReachAndViewsGoByHand) {
  Session session;
  session.scan(turned(0, 0));
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_TRUE(result);
  for (const RedRegion& region : result->map.regions) {
    EXPECT_NE(region.excuse, Excuse::kUnreachable);
  }
  ASSERT_FALSE(result->map.next.empty());
  EXPECT_FALSE(result->map.next.front().placement.has_value());
  EXPECT_NE(result->map.next.front().say.find("towards the camera"), std::string::npos);
}

TEST(RedMap, ARigWithoutHandTurnsCannotReachTheUnderside) {
  Session session;
  session.scan(turned(0, 0));
  Rig rig = turntable_rig();
  rig.hand_turns = false;
  rig.tilt_max_rad = rad_from_deg(20);
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(result);
  double unreachable = 0;
  for (const RedRegion& region : result->map.regions) {
    if (region.excuse == Excuse::kUnreachable) {
      EXPECT_FALSE(region.reason.empty());
      unreachable += region.area_mm2;
    }
  }
  EXPECT_GT(unreachable, 150.0);
}

TEST(RedMap, WhatAHandMayBringIntoDepthIsNotOutOfReach) {
  Session session;
  session.scan(turned(0, 0));
  session.scan(turned(180, 0));
  // No motors, and the pebble on its edge is 18 to 24 mm high.
  Rig rig = turntable_rig();
  rig.has_turntable = false;
  rig.tilt_max_rad = 0;
  rig.depth_range_mm = 12;
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->map.conclusive);
  double unreachable_mm2 = 0;
  double all_mm2 = 0;
  for (const RedRegion& region : result->map.regions) {
    all_mm2 += region.area_mm2;
    unreachable_mm2 += region.excuse == Excuse::kUnreachable ? region.area_mm2 : 0.0;
  }
  // Specks of the belt that no candidate sees steeply enough: 2.8 of 149 mm2, and 1.7 in a depth of 120 mm.
  EXPECT_GT(all_mm2, 100.0);
  EXPECT_LT(unreachable_mm2, 0.025 * all_mm2);
  EXPECT_TRUE(std::ranges::any_of(result->map.next, [](const NextView& view) {
    return view.say.find("above its middle to the working distance") != std::string::npos;
  }));
}

TEST(RedMap, WhatLiesOutsideTheFieldOfAllScansWasNotLookedAt) {
  Session session;
  session.half_field_mm = 4;  // of a pebble of 24 x 18 mm: its middle alone
  for (const double deg : {-9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0}) {
    session.scan(turned(deg, 0.5 * deg));
  }
  Rig rig = turntable_rig();
  rig.field_x_mm = rig.field_y_mm = 2 * session.half_field_mm;
  JobContext job;
  for (const Rig* known : {static_cast<const Rig*>(&rig), static_cast<const Rig*>(nullptr)}) {
    const auto result = make_red_map(session.map.scans(), nullptr, known, {}, job);
    ASSERT_TRUE(result);
    EXPECT_FALSE(result->map.conclusive);
    double red = 0;
    for (const RedRegion& region : result->map.regions) {
      EXPECT_NE(region.excuse, Excuse::kUnreachable) << region.area_mm2 << " mm2: " << region.reason;
      red += region.state == RegionState::kRed ? region.area_mm2 : 0.0;
    }
    EXPECT_GT(red, 20.0);
  }
}

TEST(RedMap, WhatSomeViewWouldClearIsNoLastSpeckThoughNoneIsProposed) {
  Session session;
  session.scan(turned(0, 0));
  session.scan(turned(60, 0));
  RedMapOptions options;
  options.excuse.speck_budget = 1.0;
  options.next.least_gain_mm2 = 1e9;
  JobContext job;
  const Rig rig = turntable_rig();
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, options, job);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->map.next.empty());
  EXPECT_FALSE(result->map.conclusive);
}

/// Two places far from each other, once the last specks are excused.
RedTargets two_last_specks(double first_mm2, double second_mm2, bool first_gives_signal) {
  Session session;
  session.scan(turned(0, 0));
  RedTargets red;
  red.cell_mm = 0.75;
  for (const double x : {-5.0, 5.0}) {
    RedTarget& target = red.targets.emplace_back();
    target.position_mm = target.sample_mm = {x, 0, 4.6};
    target.area_mm2 = x < 0 ? first_mm2 : second_mm2;
    target.no_signal = x < 0 && !first_gives_signal;
  }
  constexpr double kSurfaceMm2 = 1e6;
  excuse_last_specks(session.map.scans(), SurfaceCover(session.map.scans()), 0.0, kSurfaceMm2, {}, red);
  return red;
}

TEST(RedMap, ALastSpeckIsNoLargerThanHalfAWedge) {
  const RedTargets red = two_last_specks(0.4, 0.6, true);
  EXPECT_EQ(red.targets[0].excuse, Excuse::kUnneeded);
  EXPECT_EQ(red.targets[1].state, RegionState::kRed);
}

TEST(RedMap, WhatGivesNoSignalIsNoLastSpeck) {
  const RedTargets red = two_last_specks(0.3, 0.3, false);
  EXPECT_EQ(red.targets[0].state, RegionState::kRed);
  EXPECT_EQ(red.targets[1].excuse, Excuse::kUnneeded);
}

TEST(RedMap, BehindAClosedSurfaceNothingIsMissing) {
  const auto left = [](bool is_closed, bool has_rim) {
    RedTargets red;
    red.cell_mm = 0.3;
    for (int i = 0; i < 20; ++i) {
      RedTarget& target = red.targets.emplace_back();
      target.position_mm = {1.0 * i, 0, 20};
      target.area_mm2 = 1.0;
      target.unseen = true;
    }
    if (has_rim) {
      red.targets.push_back(red.targets.front());
      red.targets.back().rim = true;
    }
    drop_unbordered_patches({}, is_closed, red);
    return red.targets.size();
  };
  EXPECT_EQ(left(true, false), 0U);
  EXPECT_EQ(left(false, false), 20U);
  EXPECT_EQ(left(true, true), 21U);
}

TEST(RedMap, CancelledWorkSaysSo) {
  Session session;
  session.scan(turned(0, 0));
  JobContext job;
  job.cancel();
  const auto result = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
}

TEST(RedMap, ChecklistAddsUpFaces) {
  Session session;
  session.scan(turned(0, 0));
  JobContext job;
  const Rig rig = turntable_rig();
  const auto result = make_red_map(session.map.scans(), nullptr, &rig, {}, job);
  ASSERT_TRUE(result);
  Mesh mesh;
  mesh.positions = {{0, 0, 5}, {4, 0, 5}, {0, 3, 5}, {0, 0, -5}};
  mesh.faces = {{0, 1, 2}};
  ScanPose pose;
  pose.status = PoseStatus::kRegistered;
  pose.id = 3;
  pose.warning = "its lengths are off";
  const Checklist list =
      make_checklist(result->map, std::vector<ScanPose>{pose}, session.map.scans(), mesh, &rig);
  EXPECT_NEAR(list.faces[static_cast<std::size_t>(Face::kObverse)].seen_mm2, 6.0, 1e-6);
  EXPECT_GT(list.faces[static_cast<std::size_t>(Face::kReverse)].red_mm2, 150.0);
  EXPECT_EQ(list.scans_registered, 1);
  ASSERT_EQ(list.warnings.size(), 1U);
  EXPECT_EQ(list.warnings[0].scan, 3);
  EXPECT_EQ(list.warnings[0].text, "its lengths are off");
  EXPECT_FALSE(list.conclusive);
}

}  // namespace
}  // namespace dubsar
