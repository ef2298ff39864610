// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rig.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/units.h"

namespace dubsar {

RigidTransform stage_from_scanner(double turntable_rad, double tilt_rad, const Eigen::Vector3d& focus_mm) {
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(-turntable_rad, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  const Eigen::Vector3d turned_focus =
      Eigen::AngleAxisd(-turntable_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * focus_mm;
  return {rotation, turned_focus};
}

RigidTransform stage_from_scanner(const Placement& placement, const Eigen::Vector3d& focus_mm) {
  return placement.free_pose ? *placement.free_pose
                             : stage_from_scanner(placement.turntable_rad, placement.tilt_rad, focus_mm);
}

double tilt_of(const Placement& placement) {
  if (!placement.free_pose) {
    return placement.tilt_rad;
  }
  const Eigen::Vector3d axis = placement.free_pose->rotation.col(2);
  return std::atan2(axis.head<2>().norm(), axis.z());  // the arc cosine is blunt near the vertical
}

std::string say_placement(const Rig& rig, const Placement& placement) {
  const auto degrees = [](double rad) { return std::to_string(std::lround(deg_from_rad(rad))) + "°"; };
  if (placement.free_pose) {
    return "arm " + degrees(tilt_of(placement)) + " off the vertical";
  }
  std::string text = rig.has_turntable ? "turntable to " + degrees(placement.turntable_rad) : std::string();
  if (rig.tilt_max_rad > rig.tilt_min_rad || text.empty()) {
    text += (text.empty() ? "tilt to " : ", tilt to ") + degrees(placement.tilt_rad);
  }
  return text;
}

}  // namespace dubsar
