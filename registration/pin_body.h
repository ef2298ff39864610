// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace dubsar {

/// A pin's arm: a cone (a cylinder where the slope is 0) seen from one side.
struct Cone {
  Eigen::Vector3d point_mm{0, 0, 0};  ///< on the axis
  Eigen::Vector3d axis{0, 0, 1};      ///< unit
  double radius_mm = 0;               ///< at point_mm
  double slope = 0;                   ///< by which the radius grows along the axis
  double low_mm = 0, high_mm = 0;     ///< along the axis from point_mm: where the samples begin and end
  double inlier_share = 0;
  double rms_mm = 0;        ///< of the inliers
  double coverage_rad = 0;  ///< angle about the axis that the samples span

  [[nodiscard]] double along(const Eigen::Vector3d& p_mm) const { return (p_mm - point_mm).dot(axis); }
  [[nodiscard]] double from_axis(const Eigen::Vector3d& p_mm) const {
    const Eigen::Vector3d d = p_mm - point_mm;
    return (d - d.dot(axis) * axis).norm();
  }
  [[nodiscard]] double radius_at(double along_mm) const { return radius_mm + slope * along_mm; }
  /// The same cone with its axis the other way.
  [[nodiscard]] Cone reversed() const;
};

/// Robust least squares of the distances to a cone, radius and slope free. `to_camera` is the unit vector
/// from the samples to the camera, tolerance_mm what an inlier may be off at the end. Nothing when fewer than
/// 12 samples are inliers or the fit runs away.
[[nodiscard]] std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> points_mm,
                                           const Eigen::Vector3d& to_camera, double tolerance_mm);

/// A tip ball fitted to the half of its samples that is away from the arm.
struct Ball {
  Eigen::Vector3d center_mm{0, 0, 0};
  std::vector<std::size_t> samples;  ///< inliers, positions in the span that was fitted
  double rms_mm = 0;
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();  ///< Σ w n nᵀ
  int cap = 0;  ///< inliers well beyond the arm's end: a cut-off arm has none
  /// What a cylinder along the arm leaves of the cap's squared residuals, in parts of what the ball leaves.
  double cylinder_ratio = 0;
};

/// Least squares with the known radius, weighted by the cosine of incidence (the edges of the ball are seen
/// at a grazing angle, where the stripe's spot straddles the edge). `arm` points from the ball along its arm;
/// samples on that side of the centre are the arm's.
[[nodiscard]] std::optional<Ball> fit_ball(std::span<const Eigen::Vector3d> points_mm,
                                           const Eigen::Vector3d& start_mm, const Eigen::Vector3d& arm,
                                           const Eigen::Vector3d& to_camera, double radius_mm,
                                           double tolerance_mm);

/// Weight of a sample of the ball with outward normal n.
[[nodiscard]] double ball_weight(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_camera);

}  // namespace dubsar
