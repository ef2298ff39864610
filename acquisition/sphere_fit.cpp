// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/sphere_fit.h"

#include <Eigen/Dense>
#include <cmath>

namespace dubsar {

std::optional<Sphere> sphere_through(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                     const Eigen::Vector3d& d) {
  Eigen::Matrix3d left;
  left << (b - a).transpose(), (c - a).transpose(), (d - a).transpose();
  const double size = (b - a).norm() * (c - a).norm() * (d - a).norm();
  if (!(std::abs(left.determinant()) > 1e-3 * size) || !(size > 0)) {
    return std::nullopt;
  }
  // |p - m|² the same for all four, with m counted from a.
  const Eigen::Vector3d right(0.5 * (b - a).squaredNorm(), 0.5 * (c - a).squaredNorm(), 0.5 * (d - a).squaredNorm());
  const Eigen::Vector3d middle = left.inverse() * right;
  return Sphere{a + middle, middle.norm()};
}

std::optional<Sphere> fit_sphere(const std::vector<Eigen::Vector3d>& points_mm, const Sphere& start) {
  if (points_mm.size() < 10) {
    return std::nullopt;
  }
  Sphere sphere = start;
  constexpr int kMostSteps = 50;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const Eigen::Vector3d& p : points_mm) {
      const Eigen::Vector3d arm = p - sphere.center_mm;
      const double length = arm.norm();
      if (!(length > 1e-12)) {
        return std::nullopt;
      }
      Eigen::Vector4d slope;
      slope << -arm / length, -1;
      normal += slope * slope.transpose();
      right -= slope * (length - sphere.radius_mm);
    }
    const Eigen::Vector4d change = normal.ldlt().solve(right);
    if (!change.allFinite()) {
      return std::nullopt;
    }
    sphere.center_mm += change.head<3>();
    sphere.radius_mm += change[3];
    if (change.norm() < 1e-9) {
      return sphere.radius_mm > 0 ? std::optional(sphere) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace dubsar
