// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dubsar {

struct Sphere {
  Eigen::Vector3d center_mm{0, 0, 0};
  double radius_mm = 0;
  [[nodiscard]] double signed_distance_mm(const Eigen::Vector3d& p_mm) const {
    return (p_mm - center_mm).norm() - radius_mm;
  }
};

/// The sphere through four points; nothing when they (nearly) lie in a plane.
[[nodiscard]] std::optional<Sphere> sphere_through(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                   const Eigen::Vector3d& c, const Eigen::Vector3d& d);

/// Least squares of the distances, radius free (Gauss-Newton from `start`). Nothing when it does not settle.
[[nodiscard]] std::optional<Sphere> fit_sphere(const std::vector<Eigen::Vector3d>& points_mm, const Sphere& start);

}  // namespace dubsar
