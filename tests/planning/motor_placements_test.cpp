// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/motor_placements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "core/motion_limits.h"
#include "core/units.h"
#include "planning/sparse_flags.h"
#include "planning/view_candidates.h"

namespace dubsar {
namespace {

using testing::HasSubstr;

Rig arc_rig() {
  Rig rig;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(70);
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.camera_mm = Eigen::Vector3d(0, 110, 250);
  return rig;
}

Rig arm_rig() {
  Rig rig = arc_rig();
  rig.has_turntable = false;
  rig.robot = RobotReach{{0, -600, 0}, {150, 1000}, {0, 600}, {150, 500}};
  return rig;
}

TEST(MotorPlacements, TheTurntableStaysWithinItsLimits) {
  Rig rig = arc_rig();
  EXPECT_EQ(motor_placements(rig, {}, {0, 0, 0}, {}).size(), 4U + 4U * 18U);
  rig.turntable_rad = {rad_from_deg(-60), rad_from_deg(60)};
  const auto some = motor_placements(rig, {}, {0, 0, 0}, {});
  EXPECT_EQ(some.size(), 3U + 4U * 7U);
  for (const Placement& placement : some) {
    EXPECT_TRUE(check_limits(rig, placement, ""));
  }
}

TEST(MotorPlacements, AnArmLooksFromAllAround) {
  const Rig rig = arm_rig();
  const auto all = motor_placements(rig, {}, {0, 0, 10}, {});
  EXPECT_GT(all.size(), 100U);
  std::set<std::pair<int, int>> directions;
  for (const Placement& placement : all) {
    ASSERT_TRUE(placement.free_pose);
    EXPECT_TRUE(placement.free_pose->is_rigid(1e-9));
    EXPECT_TRUE(check_limits(rig, placement, ""));
    EXPECT_EQ(placement.free_pose->translation_mm, Eigen::Vector3d(0, 0, 10));
    const Eigen::Vector3d axis = placement.free_pose->rotation.col(2);
    directions.insert(
        {static_cast<int>(std::lround(100 * axis.x())), static_cast<int>(std::lround(100 * axis.y()))});
  }
  EXPECT_EQ(directions.size() * 4, all.size());
  Rig near = rig;
  near.robot->reach_mm.high = 500;  // the far side is out of reach
  EXPECT_LT(motor_placements(near, {}, {0, 0, 10}, {}).size(), all.size());
}

TEST(MotorPlacements, TheFirstIsAsNearToWhereItStandsAsLimitsLetIt) {
  Rig rig = arc_rig();
  const StageScene scene = unseen_tablet(rig, std::nullopt);
  EXPECT_EQ(first_placement(rig, scene, "")->tilt_rad, 0);
  rig.tilt_min_rad = rad_from_deg(20);
  rig.turntable_rad = {rad_from_deg(90), rad_from_deg(180)};
  const Placement first = first_placement(rig, scene, "").value();
  EXPECT_DOUBLE_EQ(first.tilt_rad, rad_from_deg(20));
  EXPECT_DOUBLE_EQ(first.turntable_rad, rad_from_deg(90));
  const Placement arm = first_placement(arm_rig(), scene, "").value();
  EXPECT_NEAR(tilt_of(arm), 0, 1e-9);
}

TEST(MotorPlacements, LimitsThatExcludeEveryViewAreNamed) {
  Rig rig = arm_rig();
  rig.robot->height_mm = {5, 40};  // so low that nothing stands clear of tablet and support
  const auto first = first_placement(rig, unseen_tablet(rig, std::nullopt), "rig.json");
  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(first.error().line(), HasSubstr("rig.json: the limits exclude every view"));
  rig = arc_rig();
  rig.tilt_min_rad = rig.tilt_max_rad = rad_from_deg(85);
  EXPECT_THAT(first_placement(rig, unseen_tablet(rig, std::nullopt), "f").error().line(),
              HasSubstr("support"));
}

TEST(MotorPlacements, SaidSoThatAPersonCanFollow) {
  const ModelFaces faces;
  const auto said = [&](double bearing_deg, double tilt_deg, double roll_deg) {
    RigidTransform pose =
        stage_from_scanner(rad_from_deg(bearing_deg), rad_from_deg(tilt_deg), Eigen::Vector3d::Zero());
    pose.rotation *= Eigen::AngleAxisd(rad_from_deg(roll_deg), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return say_arm(pose, Eigen::Matrix3d::Identity(), faces);
  };
  EXPECT_EQ(said(0, 0, 90), "arm straight above, rolled 90°");
  EXPECT_EQ(said(0, 35, 0), "arm to the side of the bottom edge, 35° off the vertical, rolled 0°");
  EXPECT_EQ(said(180, 35, 270), "arm to the side of the top edge, 35° off the vertical, rolled 270°");
  EXPECT_EQ(said(-90, 52, 180), "arm to the side of the right edge, 52° off the vertical, rolled 180°");
}

/// A flat square seen from straight above by the arm.
struct FlatScan {
  RangeGrid grid;
  SampleFlags flags;
  explicit FlatScan(double z_mm) {
    grid.allocate(41, 41);
    grid.spacing_mm = 0.5;
    for (int r = 0; r < 41; ++r) {
      for (int c = 0; c < 41; ++c) {
        const std::size_t i = grid.index(r, c);
        grid.x[i] = static_cast<float>(0.5 * (c - 20));
        grid.y[i] = static_cast<float>(0.5 * (r - 20));
        grid.z[i] = static_cast<float>(z_mm - 0.002 * (r - 20) * (r - 20));
        grid.valid[i] = 1;
      }
    }
    flags = flag_sparse(grid);
  }
};

TEST(MotorPlacements, CandidatesOfAnArmStandWhereTheirPlacementSays) {
  const Rig rig = arm_rig();
  const FlatScan flat(3);
  Placement now = motor_placements(rig, {}, {4, -3, 12}, {}).at(10);
  const PlacedScan scan{0, &flat.grid, &flat.flags, RigidTransform::from_twist({0.3, 0.2, 1}, {5, 1, 2}), 0};
  const RigidTransform stage_from_model = *now.free_pose * scan.model_from_scanner.inverse();
  const ModelSurface surface = model_surface({&scan, 1});
  const auto candidates = rig_candidates(rig, {0, now}, scan, surface);
  ASSERT_GT(candidates.size(), 200U);
  int without_hands = 0;
  for (const ViewCandidate& candidate : candidates) {
    ASSERT_TRUE(candidate.placement && candidate.placement->free_pose);
    EXPECT_THAT(candidate.say, HasSubstr("arm"));
    EXPECT_EQ(candidate.by_hand, candidate.placement->hand_turn.has_value());
    if (candidate.by_hand) {
      continue;
    }
    ++without_hands;
    const RigidTransform there = stage_from_model * candidate.model_from_scanner;
    EXPECT_LT((there.rotation - candidate.placement->free_pose->rotation).norm(), 1e-9);
    EXPECT_LT((there.translation_mm - candidate.placement->free_pose->translation_mm).norm(), 1e-9);
  }
  EXPECT_GT(without_hands, 50);
}

TEST(MotorPlacements, CandidatesKeepClearOfTheTablet) {
  Rig rig = arc_rig();
  const FlatScan flat(3);
  const PlacedScan scan{0, &flat.grid, &flat.flags, {}, 0};
  const ModelSurface surface = model_surface({&scan, 1});
  const std::size_t all = rig_candidates(rig, {0, {}}, scan, surface).size();
  rig.head = HeadBox{{-200, -20, 230}, {200, 20, 280}};  // a broad head tilts as far …
  rig.keep_out_margin_mm = 15;
  EXPECT_EQ(rig_candidates(rig, {0, {}}, scan, surface).size(), all);
  rig.head = HeadBox{{-20, -200, 230}, {20, 20, 280}};  // … and a long one hits the support
  const auto some = rig_candidates(rig, {0, {}}, scan, surface);
  EXPECT_LT(some.size(), all);
  EXPECT_FALSE(some.empty());
  rig.keep_out_margin_mm = 400;
  EXPECT_TRUE(rig_candidates(rig, {0, {}}, scan, surface).empty());
}

}  // namespace
}  // namespace dubsar
