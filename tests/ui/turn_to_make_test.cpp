// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "ui/operator/pose_panel.h"

namespace dubsar::ui {
namespace {

TEST(TurnToMake, TheTurnLeadsFromHowItLiesToHowItIsToLie) {
  NextView next;
  next.placement = Placement{};
  next.placement->turntable_rad = 0.7;
  next.placement->tilt_rad = 0.9;
  const Eigen::Matrix3d half_turn = Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  next.placement->hand_turn = RigidTransform{half_turn, Eigen::Vector3d::Zero()};
  const Eigen::Matrix3d then =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 1, 1).normalized()).toRotationMatrix();
  // The scanner is where the placement puts it, seen from the model.
  next.model_from_scanner.rotation =
      then.transpose() * stage_from_scanner(*next.placement, Eigen::Vector3d::Zero()).rotation;
  const TurnToMake turn = turn_to_make(next);
  EXPECT_TRUE(turn.by_hand);
  EXPECT_TRUE(turn.stage_from_model_then.isApprox(then.cast<float>(), 1e-5F));
  EXPECT_TRUE(
      (half_turn.cast<float>() * turn.stage_from_model_now).isApprox(turn.stage_from_model_then, 1e-5F));
}

TEST(TurnToMake, WithoutATurnItStays) {
  NextView next;
  next.placement = Placement{};
  const TurnToMake turn = turn_to_make(next);
  EXPECT_FALSE(turn.by_hand);
  EXPECT_TRUE(turn.stage_from_model_now.isApprox(turn.stage_from_model_then));
}

}  // namespace
}  // namespace dubsar::ui
