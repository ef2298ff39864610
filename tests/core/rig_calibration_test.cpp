// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rig_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/units.h"

namespace dubsar {
namespace {

RigCalibration rig() {
  RigCalibration rig;
  rig.camera = {2048, 1088, 10240, 10240, 1024, 544, -0.1, 0, 0, 0, 0};
  rig.laser.normal = Eigen::Vector3d(0, std::cos(0.4), -std::sin(0.4));
  rig.laser.distance_mm = rig.laser.normal.z() * 250;
  rig.motion.direction = rig.laser.normal;
  rig.working_distance_mm = 250;
  rig.depth_range_mm = 50;
  return rig;
}

TEST(RigCalibration, ScannerFrameLiesInTheLaserPlane) {
  const RigCalibration one = rig();
  ASSERT_TRUE(one.check("rig").has_value());
  const RigidTransform camera_from_scanner = one.scanner_from_camera().inverse();
  EXPECT_TRUE(camera_from_scanner.is_rigid(1e-9));
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, 0, 0), Eigen::Vector3d(0, 0, 20)}) {
    EXPECT_NEAR(one.laser.signed_distance_mm(camera_from_scanner * p), 0, 1e-9);
  }
  const ScannerView view = one.view(0.1);
  ASSERT_TRUE(view.camera_mm && view.laser_mm);
  EXPECT_GT(view.camera_mm->z(), 200);
  EXPECT_GT(view.motion_per_row_mm.y(), 0.09);
}

TEST(RigCalibration, DepthPerPixelFollowsTheTriangulationAngle) {
  const RigCalibration one = rig();
  EXPECT_NEAR(one.field_per_px_mm(), 250.0 / 10240, 1e-9);
  EXPECT_NEAR(one.depth_per_px_mm(), 250.0 / 10240 / std::sin(0.4), 1e-3);
  RigCalibration turned = one;  // the laser beside the camera: its stripe runs down
  turned.laser.normal = Eigen::Vector3d(std::cos(0.4), 0, -std::sin(0.4));
  turned.motion.direction = turned.laser.normal;
  EXPECT_NEAR(turned.depth_per_px_mm(), one.depth_per_px_mm(), 1e-3 * one.depth_per_px_mm());
}

TEST(RigCalibration, MotionTakesPointsBackToPositionZero) {
  RigMotion turn{MotionKind::kTurntable, Eigen::Vector3d::UnitX(), {0, 10, 260}};
  const Eigen::Vector3d at_zero(5, 20, 240);
  // The table turns what lies on it by +30° about its axis; the camera then sees it there.
  const Eigen::AngleAxisd table(rad_from_deg(30), turn.direction);
  const Eigen::Vector3d seen = table * (at_zero - turn.axis_point_mm) + turn.axis_point_mm;
  EXPECT_LT((turn.zero_from_camera(rad_from_deg(30)) * seen - at_zero).norm(), 1e-9);

  RigMotion mirror{MotionKind::kGalvanometer, Eigen::Vector3d::UnitX(), {0, -100, 20}};
  Plane laser{Eigen::Vector3d(0, 1, 0), -100};
  const Plane turned = mirror.laser_at(laser, 0.1);
  EXPECT_NEAR(turned.signed_distance_mm(mirror.axis_point_mm), 0, 1e-9);
  EXPECT_NEAR(std::acos(turned.normal.dot(laser.normal)), 0.1, 1e-9);
}

TEST(RigCalibration, RefusesAPlaneThroughTheCamera) {
  RigCalibration one = rig();
  one.laser.distance_mm = 0;
  EXPECT_FALSE(one.check("rig").has_value());
  one = rig();
  one.motion.direction = Eigen::Vector3d(1, 0, 0);
  EXPECT_FALSE(one.check("rig").has_value());  // along the plane
}

}  // namespace
}  // namespace dubsar
