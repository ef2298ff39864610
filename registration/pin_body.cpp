// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_body.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostFitted = 800;  ///< samples of an arm: more change nothing
constexpr int kConeRounds = 25;
constexpr int kBallRounds = 20;
constexpr double kLeastWeight = 0.15;

/// Two unit vectors across `axis`.
std::pair<Eigen::Vector3d, Eigen::Vector3d> across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d u = axis.unitOrthogonal();
  return {u, axis.cross(u)};
}

/// Axis from the second moments, radius from the width across the view.
std::optional<Cone> rough_cone(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& to_camera) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    moments += (p - mean) * (p - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  Cone cone;
  cone.axis = eigen.eigenvectors().col(2);
  const Eigen::Vector3d side = cone.axis.cross(to_camera);
  if (!(side.norm() > 0.05)) {
    return std::nullopt;  // seen along its axis
  }
  std::vector<double> offsets;
  offsets.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    offsets.push_back(std::abs((p - mean).dot(side.normalized())));
  }
  const auto rank = static_cast<std::size_t>(0.9 * static_cast<double>(offsets.size() - 1));
  cone.radius_mm = value_at_rank(offsets, rank) / 0.9;
  // A half cylinder's samples have their mean π/4 of the radius before the axis.
  const Eigen::Vector3d view = (to_camera - to_camera.dot(cone.axis) * cone.axis).normalized();
  cone.point_mm = mean - 0.25 * kPi * cone.radius_mm * view;
  return cone;
}

/// One Gauss-Newton step on the samples within `tolerance`; the number of these.
int improve(std::span<const Eigen::Vector3d> points, double tolerance, Cone& cone) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const auto [u, v] = across(cone.axis);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 g = Vector6::Zero();
  int count = 0;
  for (const Eigen::Vector3d& p : points) {
    const double s = cone.along(p);
    const Eigen::Vector3d d = p - cone.point_mm - s * cone.axis;
    const double rho = d.norm();
    const double r = rho - cone.radius_at(s);
    if (rho < 1e-9 || std::abs(r) > tolerance) {
      continue;
    }
    const double du = d.dot(u) / rho;
    const double dv = d.dot(v) / rho;
    Vector6 j;
    j << -du, -dv, -s * du, -s * dv, -1.0, -s;
    const double t = r / tolerance;
    const double w = (1 - t * t) * (1 - t * t);  // Tukey: what is of the ball or of another thing fades out
    h += w * j * j.transpose();
    g += w * r * j;
    ++count;
  }
  if (count < 12) {
    return count;
  }
  // The slope of a short piece is hardly determined: a cylinder is what is expected.
  h(5, 5) += 1e-3 * h(4, 4) * cone.radius_mm * cone.radius_mm + 1e-12;
  g[5] += 1e-3 * h(4, 4) * cone.radius_mm * cone.radius_mm * cone.slope;
  const Vector6 step = -(h + 1e-6 * h.diagonal().asDiagonal().toDenseMatrix()).ldlt().solve(g);
  if (!step.allFinite()) {
    return 0;
  }
  cone.point_mm += step[0] * u + step[1] * v;
  cone.axis =
      (cone.axis + std::clamp(step[2], -0.3, 0.3) * u + std::clamp(step[3], -0.3, 0.3) * v).normalized();
  cone.radius_mm += step[4];
  cone.slope += step[5];
  return count;
}

/// Angle about the axis that the inliers span: the whole turn less the largest gap.
double coverage(const std::vector<double>& sorted_angles) {
  if (sorted_angles.size() < 2) {
    return 0;
  }
  double gap = sorted_angles.front() + 2 * kPi - sorted_angles.back();
  for (std::size_t k = 1; k < sorted_angles.size(); ++k) {
    gap = std::max(gap, sorted_angles[k] - sorted_angles[k - 1]);
  }
  return 2 * kPi - gap;
}

}  // namespace

Cone Cone::reversed() const {
  Cone out = *this;
  out.axis = -axis;
  out.slope = -slope;
  out.low_mm = -high_mm;
  out.high_mm = -low_mm;
  return out;
}

std::optional<Cone> fit_cone(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& to_camera,
                             double tolerance_mm) {
  if (points.size() < 12) {
    return std::nullopt;
  }
  std::vector<Eigen::Vector3d> few;
  const std::size_t stride = (points.size() + kMostFitted - 1) / kMostFitted;
  for (std::size_t k = 0; k < points.size(); k += stride) {
    few.push_back(points[k]);
  }
  std::optional<Cone> cone = rough_cone(few, to_camera);
  if (!cone || !(cone->radius_mm > 0)) {
    return std::nullopt;
  }
  const double rough_mm = cone->radius_mm;
  for (int round = 0; round < kConeRounds; ++round) {
    const double tolerance = std::max(tolerance_mm, rough_mm * std::pow(0.75, round));
    if (improve(few, tolerance, *cone) < 12 || !(cone->radius_mm > 0.1 * rough_mm) ||
        !(cone->radius_mm < 10 * rough_mm) || !(std::abs(cone->slope) < 1)) {
      return std::nullopt;
    }
  }
  const auto [u, v] = across(cone->axis);
  std::vector<double> angles;
  std::vector<double> places;
  double sum2 = 0;
  for (const Eigen::Vector3d& p : few) {
    const double s = cone->along(p);
    const double r = cone->from_axis(p) - cone->radius_at(s);
    places.push_back(s);
    if (std::abs(r) <= tolerance_mm) {
      sum2 += r * r;
      const Eigen::Vector3d d = p - cone->point_mm;
      angles.push_back(std::atan2(d.dot(v), d.dot(u)));
    }
  }
  if (angles.size() < 12) {
    return std::nullopt;
  }
  std::sort(angles.begin(), angles.end());
  cone->coverage_rad = coverage(angles);
  cone->rms_mm = std::sqrt(sum2 / static_cast<double>(angles.size()));
  cone->inlier_share = static_cast<double>(angles.size()) / static_cast<double>(few.size());
  cone->low_mm = cone->high_mm = cone->along(points.front());
  for (const Eigen::Vector3d& p : points) {
    cone->low_mm = std::min(cone->low_mm, cone->along(p));
    cone->high_mm = std::max(cone->high_mm, cone->along(p));
  }
  return cone;
}

double ball_weight(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_camera) {
  return std::clamp(normal.dot(to_camera), kLeastWeight, 1.0);
}

std::optional<Ball> fit_ball(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& start_mm,
                             const Eigen::Vector3d& arm, const Eigen::Vector3d& to_camera, double radius_mm,
                             double tolerance_mm) {
  Ball ball;
  ball.center_mm = start_mm;
  for (int round = 0; round < kBallRounds; ++round) {
    const double tolerance = std::max(tolerance_mm, 0.6 * radius_mm * std::pow(0.7, round));
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double sum2 = 0;
    ball.samples.clear();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3d d = points[k] - ball.center_mm;
      const double length = d.norm();
      const double r = length - radius_mm;
      if (length < 1e-9 || std::abs(r) > tolerance || d.dot(arm) > 0.05 * radius_mm) {
        continue;
      }
      const Eigen::Vector3d n = d / length;
      const double w = ball_weight(n, to_camera);
      h += w * n * n.transpose();
      g += w * r * n;
      sum2 += r * r;
      ball.samples.push_back(k);
    }
    if (ball.samples.size() < 5) {
      return std::nullopt;
    }
    ball.normal_matrix = h;
    ball.rms_mm = std::sqrt(sum2 / static_cast<double>(ball.samples.size()));
    // Barely determined directions move slowly rather than away.
    const Eigen::Vector3d step = (h + 1e-4 * h.trace() * Eigen::Matrix3d::Identity()).ldlt().solve(g);
    if (!step.allFinite() || (ball.center_mm + step - start_mm).norm() > 2.0 * radius_mm) {
      return std::nullopt;
    }
    if (round + 1 < kBallRounds) {
      ball.center_mm += step;
    }
    if (tolerance <= tolerance_mm && step.norm() < 1e-5 * radius_mm) {
      break;
    }
  }
  double of_ball = 1e-12;
  double of_cylinder = 0;
  for (const std::size_t k : ball.samples) {
    const Eigen::Vector3d d = points[k] - ball.center_mm;
    const double s = d.dot(arm);
    if (s < -0.35 * radius_mm) {
      ++ball.cap;
      of_ball += std::pow(d.norm() - radius_mm, 2);
      of_cylinder += std::pow((d - s * arm).norm() - radius_mm, 2);
    }
  }
  ball.cylinder_ratio = of_cylinder / of_ball;
  return ball;
}

}  // namespace dubsar
