// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dubsar {

/// Tangent of the smallest angle of the triangle, the one across from its shortest side; 0 when it has no
/// area.
[[nodiscard]] inline double least_tangent(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                          const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, bc = c - b, ca = a - c;
  const double area2 = ab.cross(ca).norm();
  if (!(area2 > 0)) {
    return 0;
  }
  const double ab2 = ab.squaredNorm(), bc2 = bc.squaredNorm(), ca2 = ca.squaredNorm();
  const double beside = ab2 <= bc2 && ab2 <= ca2 ? bc.dot(ca) : bc2 <= ca2 ? ca.dot(ab) : ab.dot(bc);
  return area2 / -beside;  // of an angle of 60° at most: the sides beside it are not at right angles
}

}  // namespace dubsar
