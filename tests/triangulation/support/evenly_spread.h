// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "core/rigid_transform.h"

namespace dubsar::test {

/// The k-th of `count` scanner poses spread evenly over the sphere, all looking at the tablet's centre.
inline RigidTransform tablet_from_scanner(int k, int count) {
  const double z = 1 - 2 * (k + 0.5) / count;
  const double phi = k * 2.399963;
  const double r = std::sqrt(1 - z * z);
  const Eigen::Vector3d out(r * std::cos(phi), r * std::sin(phi), z);
  const Eigen::Vector3d x =
      (std::abs(z) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()).cross(out).normalized();
  RigidTransform pose;
  pose.rotation.col(0) = x;
  pose.rotation.col(1) = out.cross(x);
  pose.rotation.col(2) = out;
  return pose;
}

}  // namespace dubsar::test
