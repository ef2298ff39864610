// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace dubsar {

/// A rotation and a translation in millimetres. Named target_from_source: it takes source points to the
/// target.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    return rotation * p + translation_mm;
  }
  [[nodiscard]] RigidTransform operator*(const RigidTransform& b) const {
    return {rotation * b.rotation, rotation * b.translation_mm + translation_mm};
  }
  [[nodiscard]] RigidTransform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation_mm)};
  }
  /// Angle of the rotation, radians, in [0, pi].
  [[nodiscard]] double angle_rad() const;
  /// The same transform with its rotation put back onto SO(3) (products drift).
  [[nodiscard]] RigidTransform orthonormalised() const;
  /// 16 numbers, row major, last row 0 0 0 1.
  [[nodiscard]] std::array<double, 16> row_major() const;
  /// From 16 row-major numbers; the rotation is taken as it is: see is_rigid().
  [[nodiscard]] static RigidTransform from_row_major(const std::array<double, 16>& m);
  /// Finite and a right-handed rotation within the tolerance.
  [[nodiscard]] bool is_rigid(double tolerance = 1e-3) const;
  /// exp of a twist: rotation vector omega (radians) about the origin, then the translation v (mm).
  [[nodiscard]] static RigidTransform from_twist(const Eigen::Vector3d& omega_rad,
                                                 const Eigen::Vector3d& v_mm);
};

}  // namespace dubsar
