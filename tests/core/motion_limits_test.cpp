// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/motion_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/units.h"
#include "tests/support/comma_locale.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

Rig arc_rig() {
  Rig rig;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(70);
  return rig;
}

Rig arm_rig() {
  Rig rig;
  rig.tilt_max_rad = rad_from_deg(70);
  rig.head = HeadBox{{-10, -10, 190}, {10, 10, 210}};
  rig.robot = RobotReach{{0, 0, 0}, {100, 500}, {50, 400}, {100, 300}};
  return rig;
}

Placement drive(double turntable_deg, double tilt_deg) {
  Placement placement;
  placement.turntable_rad = rad_from_deg(turntable_deg);
  placement.tilt_rad = rad_from_deg(tilt_deg);
  return placement;
}

Range deg(double low, double high) {
  return {rad_from_deg(low), rad_from_deg(high)};
}

TEST(MotionLimits, TiltAndTurntable) {
  Rig rig = arc_rig();
  EXPECT_TRUE(check_limits(rig, drive(1000, 70), ""));
  EXPECT_THAT(check_limits(rig, drive(0, 71), "dev").error().line(),
              HasSubstr("dev: tilt 71.00 deg is out of limits; it goes from 0.00 to 70.00 deg"));
  EXPECT_FALSE(check_limits(rig, drive(0, NAN), ""));
  EXPECT_FALSE(check_limits(rig, drive(NAN, 0), ""));
  rig.turntable_rad = deg(-90, 90);
  EXPECT_TRUE(check_limits(rig, drive(-90, 0), ""));
  EXPECT_FALSE(check_limits(rig, drive(91, 0), ""));
  rig.has_turntable = false;
  EXPECT_FALSE(check_limits(rig, drive(10, 0), ""));
}

TEST(MotionLimits, AnArmsReachHeightStandoffAndTilt) {
  const Rig rig = arm_rig();
  const auto at = [](const Eigen::Vector3d& focus, double tilt_deg) {
    Placement placement;
    placement.free_pose = stage_from_scanner(0.3, rad_from_deg(tilt_deg), Eigen::Vector3d::Zero());
    placement.free_pose->translation_mm = focus;
    return placement;
  };
  EXPECT_TRUE(check_limits(rig, at({0, 0, 20}, 30), ""));
  EXPECT_THAT(check_limits(rig, at({0, 0, 150}, 0), "").error().line(), HasSubstr("stand-off"));
  EXPECT_THAT(check_limits(rig, at({0, 0, 20}, 75), "").error().line(), HasSubstr("tilt 75.00"));
  EXPECT_THAT(check_limits(rig, at({0, 0, -155}, 0), "").error().line(), HasSubstr("reach"));
  EXPECT_THAT(check_limits(rig, at({150, 150, -155}, 0), "").error().line(), HasSubstr("height"));
  EXPECT_FALSE(check_limits(rig, drive(0, 10), ""));
  EXPECT_FALSE(check_limits(arc_rig(), at({0, 0, 20}, 30), ""));
  Placement skew = at({0, 0, 20}, 0);
  skew.free_pose->rotation(0, 1) = 1;
  EXPECT_FALSE(check_limits(rig, skew, ""));
  Placement nan = at({0, 0, NAN}, 0);
  EXPECT_FALSE(check_limits(rig, nan, ""));
}

TEST(MotionLimits, TheyOnlyEverNarrow) {
  RigLimits limits;
  limits.tilt_rad = deg(-10, 50);
  limits.turntable_rad = deg(-30, 30);
  limits.margin_mm = 3;
  const Rig rig = narrowed(arc_rig(), limits, "f").value();
  EXPECT_DOUBLE_EQ(rig.tilt_min_rad, 0);
  EXPECT_DOUBLE_EQ(rig.tilt_max_rad, rad_from_deg(50));
  EXPECT_FALSE(rig.turns_fully());
  EXPECT_DOUBLE_EQ(rig.turntable_rad.low, rad_from_deg(-30));
  EXPECT_DOUBLE_EQ(rig.keep_out_margin_mm, 15);
  EXPECT_TRUE(rig.hand_turns);
  limits.turntable_rad = deg(20, 90);  // a second file narrows further
  EXPECT_DOUBLE_EQ(narrowed(rig, limits, "f")->turntable_rad.high, rad_from_deg(30));
  limits.reach_mm = Range{150, 9000};
  limits.no_hand_turns = true;
  limits.turntable_rad.reset();
  const Rig arm = narrowed(arm_rig(), limits, "f").value();
  EXPECT_DOUBLE_EQ(arm.robot->reach_mm.low, 150);
  EXPECT_DOUBLE_EQ(arm.robot->reach_mm.high, 500);
  EXPECT_FALSE(arm.hand_turns);
}

TEST(MotionLimits, NothingLeftOfARangeIsNamed) {
  RigLimits limits;
  limits.tilt_rad = deg(80, 90);
  const auto rig = narrowed(arc_rig(), limits, "rig.json");
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(rig.error().line(), HasSubstr("rig.json: the limits exclude every view: tilt 80.00 to 90.00"));
}

TEST(MotionLimits, AreToldWithThePointWhateverTheHostsLocale) {
  const test::CommaLocale comma;
  if (!test::CommaLocale::is_set()) {
    GTEST_SKIP() << "no locale with a decimal comma can be made here";
  }
  EXPECT_THAT(check_limits(arc_rig(), drive(0, 71), "dev").error().line(),
              HasSubstr("from 0.00 to 70.00 deg"));
}

}  // namespace
}  // namespace dubsar
