// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rig.h"

#include <Eigen/Geometry>

namespace dubsar {

RigidTransform stage_from_scanner(double turntable_rad, double tilt_rad, const Eigen::Vector3d& focus_mm) {
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(-turntable_rad, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  const Eigen::Vector3d turned_focus =
      Eigen::AngleAxisd(-turntable_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * focus_mm;
  return {rotation, turned_focus};
}

}  // namespace dubsar
