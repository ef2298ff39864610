// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "core/camera_model.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// Whether the stripe runs down the picture rather than across: the laser's plane (camera frame) then holds
/// the camera's y more than its x.
[[nodiscard]] inline bool runs_down(const Plane& laser) {
  return std::abs(laser.normal.x()) > std::abs(laser.normal.y());
}

/// How far the picture holds the measuring volume's middle, from the origin along the scanner's z, mm:
/// towards the camera and away from it, at most half of `depth_range_mm` each.
struct SeenDepth {
  double near_mm = 0;
  double far_mm = 0;
};
[[nodiscard]] SeenDepth seen_depth(const CameraModel& camera, const Plane& laser, double depth_range_mm);

/// Standard deviation of a point in the measuring volume against the others, the largest, mm: of the part of
/// the volume that the picture sees, up to its ends. `unknowns` are
/// fx fy cx cy k1 k2 p1 p2 k3, the laser plane's normal over its distance, the stage's direction, a point of
/// its axis (18), `joint` their covariance (18 x 18). The rigid motion of all points together, which no
/// measurement can see, is taken out. `stage`: a slide counts over 40 mm of its way, a turntable over 30
/// degrees to either side; nothing, and a mirror: the volume as it is seen at position 0.
[[nodiscard]] double volume_sigma_mm(const CameraModel& camera, const Eigen::VectorXd& unknowns,
                                     const Eigen::MatrixXd& joint, std::optional<MotionKind> stage,
                                     double depth_range_mm);

}  // namespace dubsar
