// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/keep_out.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/motion_limits.h"
#include "core/random.h"
#include "core/units.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

/// A head of 40 x 80 x 40 mm, 120 mm above what it looks at.
Rig arc_rig() {
  Rig rig;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(80);
  rig.head = HeadBox{{-20, -40, 100}, {20, 40, 140}};
  rig.keep_out_margin_mm = 10;
  return rig;
}

Rig arm_rig() {
  Rig rig = arc_rig();
  rig.has_turntable = false;
  rig.robot = RobotReach{{0, -400, 0}, {50, 900}, {0, 600}, {20, 600}};
  return rig;
}

StageScene tablet(double half_x, double half_y, double height) {
  StageScene scene;
  scene.focus_mm = {0, 0, 0.5 * height};
  scene.tablet_mm.extend(Eigen::Vector3d(-half_x, -half_y, 0));
  scene.tablet_mm.extend(Eigen::Vector3d(half_x, half_y, height));
  return scene;
}

Placement arm_at(double bearing_deg, double tilt_deg, const Eigen::Vector3d& focus) {
  Placement placement;
  placement.free_pose =
      stage_from_scanner(rad_from_deg(bearing_deg), rad_from_deg(tilt_deg), Eigen::Vector3d::Zero());
  placement.free_pose->translation_mm = focus;
  return placement;
}

Placement tilted(double tilt_deg, double turn_deg = 0) {
  Placement placement;
  placement.tilt_rad = rad_from_deg(tilt_deg);
  placement.turntable_rad = rad_from_deg(turn_deg);
  return placement;
}

/// The smallest distance of points of the head from the box, by brute force.
double clearance_mm(const Rig& rig, const Eigen::AlignedBox3d& box, const RigidTransform& pose) {
  const HeadBox head = *head_of(rig);
  double least = 1e9;
  for (int i = 0; i <= 8; ++i) {
    for (int j = 0; j <= 8; ++j) {
      for (int k = 0; k <= 8; ++k) {
        const Eigen::Vector3d share(i / 8.0, j / 8.0, k / 8.0);
        const Eigen::Vector3d p = head.low_mm + share.cwiseProduct(head.high_mm - head.low_mm);
        least = std::min(least, box.exteriorDistance(pose * p));
      }
    }
  }
  return least;
}

TEST(KeepOut, AgreesWithPointsOfTheHead) {
  const Rig rig = arm_rig();
  Random random(3);
  int refused = 0;
  int allowed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Eigen::Vector3d size{random.uniform(5, 80), random.uniform(5, 80), random.uniform(5, 90)};
    const StageScene scene = tablet(size.x(), size.y(), size.z());
    const double around_deg = random.uniform(0, 360);
    Placement placement = arm_at(around_deg, random.uniform(0, 80), scene.focus_mm);
    placement.free_pose->translation_mm +=
        Eigen::Vector3d{random.uniform(-60, 60), random.uniform(-60, 60), 0};
    const bool clear = check_clear(rig, scene, placement, "").has_value();
    const double gap = clearance_mm(rig, scene.tablet_mm, *placement.free_pose);
    if (clear) {
      EXPECT_GE(gap, rig.keep_out_margin_mm);  // never nearer than the margin
    }
    refused += clear ? 0 : 1;
    allowed += clear ? 1 : 0;
  }
  EXPECT_GT(refused, 40);
  EXPECT_GT(allowed, 40);
}

TEST(KeepOut, TheHeadStaysAboveTheSupport) {
  const Rig rig = arc_rig();
  const StageScene scene = tablet(10, 10, 10);
  EXPECT_TRUE(check_clear(rig, scene, tilted(0), ""));
  EXPECT_TRUE(check_clear(rig, scene, tilted(45), ""));
  const Status low = check_clear(rig, scene, tilted(75), "rig");
  ASSERT_FALSE(low);
  EXPECT_EQ(low.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(low.error().line(), HasSubstr("rig: the scanner's head would touch the support"));
}

TEST(KeepOut, ATallTabletIsKeptOutOfAndWhatTheTurntableSweepsToo) {
  const Rig rig = arc_rig();
  StageScene scene = tablet(10, 10, 60);
  scene.focus_mm.z() = 20;
  EXPECT_TRUE(check_clear(rig, scene, tilted(0), ""));
  scene.tablet_mm.extend(Eigen::Vector3d(0, 0, 115));  // the head begins at 120
  EXPECT_THAT(check_clear(rig, scene, tilted(0), "").error().line(), HasSubstr("keep-out volume"));
  // A long tablet that lies along x is out of the way of a head that tilts over y, until it is turned.
  scene = tablet(95, 5, 50);
  Rig still = rig;
  still.has_turntable = false;
  EXPECT_TRUE(check_clear(still, scene, tilted(50), ""));
  EXPECT_FALSE(check_clear(rig, scene, tilted(50), ""));
}

TEST(KeepOut, WithoutAHeadNothingIsKnownAndLaserAndCameraMakeOne) {
  Rig rig = arc_rig();
  rig.head.reset();
  EXPECT_FALSE(head_of(rig));
  EXPECT_TRUE(check_clear(rig, tablet(10, 10, 500), tilted(0), ""));
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 200);
  rig.view.camera_mm = Eigen::Vector3d(0, 80, 200);
  rig.view.motion_per_row_mm = {0, 0.1, 0};
  rig.field_y_mm = 60;
  const HeadBox head = head_of(rig).value();
  EXPECT_LE(head.low_mm.y(), -30 - 30);
  EXPECT_GE(head.high_mm.y(), 80 + 30 + 30);
  EXPECT_LT(head.low_mm.z(), 200);
  EXPECT_FALSE(check_clear(rig, tablet(10, 10, 500), tilted(0), ""));
}

TEST(KeepOut, TheWayIsLookedAtAndNotOnlyItsEnds) {
  // A tall tablet under the middle of the arc: both ends are clear, the middle is not.
  Rig rig = arm_rig();
  rig.head = HeadBox{{-10, -10, 60}, {10, 10, 80}};
  const StageScene scene = tablet(5, 5, 70);
  const Placement from = arm_at(0, 60, {0, 0, 10});
  const Placement to = arm_at(0, -60, {0, 0, 10});
  ASSERT_TRUE(check_clear(rig, scene, from, ""));
  ASSERT_TRUE(check_clear(rig, scene, to, ""));
  EXPECT_FALSE(check_way(rig, scene, from, to, ""));
  const auto way = safe_way(rig, scene, from, to, "");
  ASSERT_TRUE(way) << way.error().line();
  EXPECT_GT(way->size(), 1U);  // out, round and in
  const Placement* at = &from;
  for (const Placement& stop : *way) {
    EXPECT_TRUE(check_way(rig, scene, *at, stop, ""));
    for (int k = 0; k <= 200; ++k) {
      const Placement here = on_the_way(*at, stop, k / 200.0);
      EXPECT_GE(clearance_mm(rig, scene.tablet_mm, *here.free_pose), rig.keep_out_margin_mm - 1e-6);
    }
    at = &stop;
  }
  EXPECT_EQ(at->free_pose->row_major(), to.free_pose->row_major());
}

TEST(KeepOut, AWayThatThereIsNotIsRefusedBeforeItBegins) {
  Rig rig = arm_rig();
  rig.head = HeadBox{{-10, -10, 60}, {10, 10, 80}};
  rig.robot->standoff_mm = {0, 85};  // no room to back off
  const auto way =
      safe_way(rig, tablet(5, 5, 70), arm_at(0, 60, {0, 0, 10}), arm_at(0, -60, {0, 0, 10}), "arm");
  ASSERT_FALSE(way);
  EXPECT_THAT(way.error().line(), HasSubstr("on the way"));
}

TEST(KeepOut, ADirectWayIsTakenWhereItIsClear) {
  const StageScene scene = tablet(20, 15, 12);
  const auto arc = safe_way(arc_rig(), scene, tilted(0), tilted(40, 200), "");
  ASSERT_TRUE(arc);
  EXPECT_EQ(arc->size(), 1U);
  Placement goal = arm_at(90, 30, scene.focus_mm);
  goal.hand_turn = RigidTransform{};
  const auto arm = safe_way(arm_rig(), scene, arm_at(0, 30, scene.focus_mm), goal, "");
  ASSERT_TRUE(arm) << arm.error().line();
  ASSERT_EQ(arm->size(), 1U);
  EXPECT_TRUE(arm->front().hand_turn);
}

TEST(KeepOut, AnUnseenTabletIsTakenForAllThatItMayBe) {
  Rig rig = arc_rig();
  rig.field_x_mm = rig.field_y_mm = rig.depth_range_mm = 60;
  const StageScene any = unseen_tablet(rig, std::nullopt);
  EXPECT_GE(any.tablet_mm.max().x(), 30);
  const StageScene known = unseen_tablet(rig, Eigen::Vector3d(50, 40, 20));
  EXPECT_GE(known.tablet_mm.max().x(), 0.5 * std::hypot(50, 40));
  EXPECT_DOUBLE_EQ(known.tablet_mm.max().z(), 50);  // it may stand on its edge
}

}  // namespace
}  // namespace dubsar
