// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rigid_transform.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace dubsar {

double RigidTransform::angle_rad() const {
  // atan2 of the skew part keeps small angles, where acos of the trace loses them.
  const Eigen::Vector3d skew(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                             rotation(1, 0) - rotation(0, 1));
  return std::atan2(skew.norm(), rotation.trace() - 1.0);
}

RigidTransform RigidTransform::orthonormalised() const {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d fix = Eigen::Matrix3d::Identity();
  fix(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  return {svd.matrixU() * fix * svd.matrixV().transpose(), translation_mm};
}

std::array<double, 16> RigidTransform::row_major() const {
  std::array<double, 16> m{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      m[static_cast<std::size_t>(4 * r + c)] = rotation(r, c);
    }
    m[static_cast<std::size_t>(4 * r + 3)] = translation_mm[r];
  }
  m[15] = 1.0;
  return m;
}

RigidTransform RigidTransform::from_row_major(const std::array<double, 16>& m) {
  RigidTransform t;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      t.rotation(r, c) = m[static_cast<std::size_t>(4 * r + c)];
    }
    t.translation_mm[r] = m[static_cast<std::size_t>(4 * r + 3)];
  }
  return t;
}

bool RigidTransform::is_rigid(double tolerance) const {
  return rotation.allFinite() && translation_mm.allFinite() &&
         (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() <= tolerance &&
         rotation.determinant() > 0;
}

RigidTransform RigidTransform::from_twist(const Eigen::Vector3d& omega_rad, const Eigen::Vector3d& v_mm) {
  const double angle = omega_rad.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(omega_rad / angle) : Eigen::Vector3d::UnitX();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), v_mm};
}

}  // namespace dubsar
