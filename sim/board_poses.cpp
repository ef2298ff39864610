// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/board_poses.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

/// The middle of the pattern at `at_mm`, the board turned.
RigidTransform laid(const Eigen::Matrix3d& turn, const Eigen::Vector2d& low_mm,
                    const Eigen::Vector2d& high_mm, const Eigen::Vector3d& at_mm) {
  const Eigen::Vector2d middle = 0.5 * (low_mm + high_mm);
  return {turn, at_mm - turn * Eigen::Vector3d(middle.x(), middle.y(), 0)};
}

}  // namespace

std::vector<RigidTransform> board_poses(const RigCalibration& rig, const Eigen::Vector2d& low_mm,
                                        const Eigen::Vector2d& high_mm, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<RigidTransform> out;
  const double field_x = rig.camera.width * rig.field_per_px_mm();
  const double field_y = rig.camera.height * rig.field_per_px_mm();
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2 * kPi * (i + 0.3 * random.uniform()) / 5.3;
    const double tilt = rad_from_deg(random.uniform(20, 40));
    const Eigen::Vector3d axis(std::cos(azimuth), std::sin(azimuth), 0);
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(tilt, axis) *
                                  Eigen::AngleAxisd(random.uniform(-0.15, 0.15), Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
    // Near, in the middle and far by turns, as far as the volume goes.
    const double depth = rig.depth_range_mm * (0.3 * (i % 3 - 1) + random.uniform(-0.08, 0.08));
    out.push_back(laid(turn, low_mm, high_mm,
                       {field_x * random.uniform(-0.15, 0.15), field_y * random.uniform(-0.2, 0.2),
                        rig.working_distance_mm + depth}));
  }
  return out;
}

std::vector<RigidTransform> carried_board(const RigCalibration& rig, const Eigen::Vector2d& low_mm,
                                          const Eigen::Vector2d& high_mm,
                                          const std::vector<double>& positions) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(rad_from_deg(20), Eigen::Vector3d(1, 0.4, 0).normalized()).toRotationMatrix();
  const RigidTransform at_zero = laid(turn, low_mm, high_mm, {0, 0, rig.working_distance_mm});
  std::vector<RigidTransform> out;
  for (const double position : positions) {
    out.push_back(rig.motion.zero_from_camera(position).inverse() * at_zero);
  }
  return out;
}

}  // namespace dubsar::sim
