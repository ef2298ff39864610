// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/shown_pins.h"

#include <gtest/gtest.h>

#include <numbers>

namespace dubsar {
namespace {

ScanPose pose_of(int id, PoseStatus status, double turn_rad, const Eigen::Vector3d& shift_mm) {
  ScanPose pose;
  pose.id = id;
  pose.status = status;
  pose.model_from_scanner.rotation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.model_from_scanner.translation_mm = shift_mm;
  return pose;
}

TEST(ShownPins, StandWhereTheScansThatShowThemAreOnTheModel) {
  const std::vector<ScanPose> poses = {pose_of(0, PoseStatus::kRegistered, 0, {0, 0, 0}),
                                       pose_of(1, PoseStatus::kRegistered, 0.5 * std::numbers::pi, {1, 0, 0}),
                                       pose_of(2, PoseStatus::kUnsure, 0, {0, 0, 0})};
  PinSet pins;
  pins.tips[0] = {{7, {10, 0, 5}}, {kFirstRimLabel + 2, {0, 3, 0}}, {-1, {1, 1, 1}}};
  pins.tips[1] = {{7, {0.2, -9, 5}}};  // in the model at (10, 0.2, 5): put back, nearly
  pins.tips[2] = {{7, {50, 50, 50}}};  // nobody knows where that is
  pins.tips[9] = {{4, {1, 2, 3}}};     // no such scan
  const std::vector<ShownPin> shown = shown_pins(pins, poses);
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(shown[0].label, 7);
  EXPECT_EQ(shown[0].scans, (std::vector<int>{0, 1}));
  EXPECT_LT((shown[0].position_mm - Eigen::Vector3d(10, 0.1, 5)).norm(), 1e-9);
  EXPECT_EQ(pin_name(shown[0].label), "7");
  EXPECT_EQ(pin_name(shown[1].label), "C");
  EXPECT_LT((shown[1].position_mm - Eigen::Vector3d(0, 3, 0)).norm(), 1e-9);
}

TEST(ShownPins, APinThatWasMovedStandsAtBothPlaces) {
  const std::vector<ScanPose> poses = {pose_of(0, PoseStatus::kRegistered, 0, {0, 0, 0}),
                                       pose_of(1, PoseStatus::kRegistered, 0, {0, 0, 0})};
  PinSet pins;
  pins.tips[0] = {{3, {10, 0, 5}}};
  pins.tips[1] = {{3, {10, 4, 5}}};
  const std::vector<ShownPin> shown = shown_pins(pins, poses);
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(shown[0].scans, std::vector<int>{0});
  EXPECT_EQ(shown[1].scans, std::vector<int>{1});
}

}  // namespace
}  // namespace dubsar
