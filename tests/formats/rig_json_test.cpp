// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/rig_json.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(RigJson, RoundTrip) {
  Rig rig;
  rig.name = "bench \"A\"";
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.motion_per_row_mm = {0, 0.1, 0};
  rig.spacing_mm = 0.05;
  rig.has_turntable = true;
  rig.tilt_max_rad = 1.2;
  rig.support_height_mm = 2;
  rig.calibration_age_days = 3.5;
  rig.calibration_check = {"2026-01-02", "ball bar 7", 0.012};
  const Result<Rig> back = parse_rig(rig_to_json(rig), "rig");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->name, rig.name);
  EXPECT_EQ(*back->view.laser_mm, *rig.view.laser_mm);
  EXPECT_FALSE(back->view.camera_mm);
  EXPECT_EQ(back->spacing_mm, 0.05);
  EXPECT_TRUE(back->has_turntable);
  EXPECT_EQ(back->tilt_max_rad, 1.2) << "to the last digit";
  ASSERT_TRUE(back->calibration_check);
  EXPECT_EQ(back->calibration_check->artefact, "ball bar 7");
  EXPECT_EQ(back->calibration_check->error_mm, 0.012);
  EXPECT_EQ(back->calibration_age_days, 3.5);
  EXPECT_EQ(rig_to_json(*back), rig_to_json(*parse_rig(rig_to_json(*back), "rig")));
}

TEST(RigJson, ArmHeadAndLimits) {
  Rig rig;
  rig.view.motion_per_row_mm = {0, 0.1, 0};
  rig.has_turntable = true;
  rig.turntable_rad = {-1, 2};
  rig.head = HeadBox{{-1, -2, 3}, {4, 5, 6}};
  rig.robot = RobotReach{{1, 2, 3}, {10, 20}, {30, 40}, {50, 60}};
  rig.keep_out_margin_mm = 22;
  const Result<Rig> back = parse_rig(rig_to_json(rig), "rig");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_NEAR(back->turntable_rad.low, -1, 1e-12);
  EXPECT_NEAR(back->turntable_rad.high, 2, 1e-12);
  ASSERT_TRUE(back->head && back->robot);
  EXPECT_EQ(back->head->high_mm, rig.head->high_mm);
  EXPECT_EQ(back->robot->base_mm, rig.robot->base_mm);
  EXPECT_EQ(back->robot->reach_mm.high, 20);
  EXPECT_EQ(back->robot->height_mm.low, 30);
  EXPECT_EQ(back->robot->standoff_mm.high, 60);
  EXPECT_EQ(back->keep_out_margin_mm, 22);
}

/// Radians that have no finite number of degrees were read, and written as what cannot be read again.
TEST(RigJson, AnglesOutOfAllReasonAreRefused) {
  Rig rig;
  rig.view.motion_per_row_mm = {0, 0.1, 0};
  rig.tilt_max_rad = 1.25;
  std::string text = rig_to_json(rig);
  text.replace(text.find("1.25"), 4, "1.25e307");
  const Result<Rig> tilt = parse_rig(text, "rig");
  ASSERT_FALSE(tilt);
  EXPECT_NE(tilt.error().line().find("tilt_rad is out of all reason"), std::string::npos)
      << tilt.error().line();
  rig.tilt_min_rad = -kMostTurnRad;
  rig.tilt_max_rad = kMostTurnRad;
  rig.has_turntable = true;
  rig.turntable_rad = {-kMostTurnRad, -kMostTurnRad};
  const Result<Rig> most = parse_rig(rig_to_json(rig), "rig");
  ASSERT_TRUE(most) << most.error().line();
  EXPECT_EQ(most->tilt_max_rad, kMostTurnRad);
  rig.turntable_rad = {2 * kMostTurnRad, 2 * kMostTurnRad};
  const Result<Rig> turntable = parse_rig(rig_to_json(rig), "rig");
  ASSERT_FALSE(turntable);
  EXPECT_NE(turntable.error().line().find("turntable_deg"), std::string::npos) << turntable.error().line();
}

TEST(RigJson, ATiltFromMoreToLessIsRefused) {
  Rig rig;
  rig.view.motion_per_row_mm = {0, 0.1, 0};
  rig.tilt_min_rad = 1;
  const Result<Rig> back = parse_rig(rig_to_json(rig), "rig");
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().line().find("goes from more to less"), std::string::npos) << back.error().line();
}

TEST(RigJson, NamesWhatIsMissing) {
  const Result<Rig> rig = parse_rig(R"({"name":"x"})", "session");
  ASSERT_FALSE(rig);
  EXPECT_NE(rig.error().line().find("view"), std::string::npos) << rig.error().line();
}

}  // namespace
}  // namespace dubsar
