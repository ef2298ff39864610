// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/frame_rig.h"

#include <cmath>

namespace dubsar::sim {

RigCalibration frame_rig(const FrameRigOptions& options) {
  RigCalibration rig;
  CameraModel& camera = rig.camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.fx_px = options.distance_mm / (options.field_mm / options.width);
  camera.fy_px = camera.fx_px;
  // No lens sits in the middle of its sensor, and none is free of distortion.
  camera.cx_px = 0.503 * options.width;
  camera.cy_px = 0.494 * options.height;
  camera.k1 = options.k1;
  camera.p1 = 2e-4;
  camera.p2 = -1e-4;
  rig.camera_serial = "SIM-CAMERA";
  const Eigen::Vector3d middle(0, 0, options.distance_mm);
  // y of the image points down, the laser comes from above it.
  const Eigen::Vector3d towards_laser(0, -std::sin(options.angle_rad), -std::cos(options.angle_rad));
  rig.laser_source_mm = middle + options.distance_mm * towards_laser;
  rig.laser.normal = Eigen::Vector3d(0, std::cos(options.angle_rad), -std::sin(options.angle_rad));
  rig.laser.distance_mm = rig.laser.normal.dot(middle);
  rig.working_distance_mm = options.distance_mm;
  // What the image holds along the laser, with a margin of a tenth on either side.
  const double seen = options.height / camera.fy_px * options.distance_mm / std::sin(options.angle_rad);
  rig.depth_range_mm = 0.8 * seen;
  rig.motion.kind = options.motion;
  switch (options.motion) {
    case MotionKind::kLinear:
      rig.motion.direction = rig.laser.normal;
      break;
    case MotionKind::kGalvanometer:
      rig.motion.direction = Eigen::Vector3d::UnitX();
      rig.motion.axis_point_mm = *rig.laser_source_mm;
      break;
    case MotionKind::kTurntable:
      rig.motion.direction = Eigen::Vector3d::UnitX();
      rig.motion.axis_point_mm = middle - 20 * towards_laser;
      break;
  }
  rig.made_at = "2026-01-01T00:00:00Z";
  rig.note = "truth of a simulated rig";
  return rig;
}

}  // namespace dubsar::sim
