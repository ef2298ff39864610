// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// D. C. Brown, Close-range camera calibration, Photogrammetric Engineering 37(8), 1971; coefficients in
// OpenCV's order and sense.
#include "core/camera_model.h"

#include <Eigen/LU>
#include <cmath>
#include <initializer_list>
#include <string>

namespace dubsar {

namespace {

constexpr int kMaxSteps = 20;
constexpr double kEnough = 1e-12;  // of a normalised coordinate: 1e-8 px at any lens

/// d(distorted)/d(undistorted) in normalised coordinates.
Eigen::Matrix2d jacobian(const CameraModel& c, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2 * (c.k1 + r2 * (2 * c.k2 + r2 * 3 * c.k3));  // d radial / d r2, twice
  Eigen::Matrix2d j;
  j(0, 0) = radial + x * x * slope + 2 * c.p1 * y + 6 * c.p2 * x;
  j(0, 1) = x * y * slope + 2 * c.p1 * x + 2 * c.p2 * y;
  j(1, 0) = x * y * slope + 2 * c.p2 * y + 2 * c.p1 * x;
  j(1, 1) = radial + y * y * slope + 2 * c.p2 * x + 6 * c.p1 * y;
  return j;
}

Eigen::Vector2d bend(const CameraModel& c, const Eigen::Vector2d& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
          y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
}

}  // namespace

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& normalised) const {
  const Eigen::Vector2d bent = bend(*this, normalised);
  return {fx_px * bent.x() + cx_px, fy_px * bent.y() + cy_px};
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& p_mm) const {
  return distort({p_mm.x() / p_mm.z(), p_mm.y() / p_mm.z()});
}

std::optional<Eigen::Vector2d> CameraModel::undistort(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target{(pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px};
  Eigen::Vector2d n = target;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Matrix2d j = jacobian(*this, n);
    if (!(j.determinant() > 0) || !(j(0, 0) > 0)) {
      return std::nullopt;
    }
    const Eigen::Vector2d change = j.inverse() * (target - bend(*this, n));
    n += change;
    if (!n.allFinite()) {
      return std::nullopt;
    }
    if (change.norm() < kEnough) {
      return jacobian(*this, n).determinant() > 0 ? std::optional(n) : std::nullopt;
    }
  }
  return std::nullopt;
}

Status CameraModel::check(const std::string& where) const {
  constexpr int kMostPixels = 1 << 16;
  if (width < 2 || height < 2 || width > kMostPixels || height > kMostPixels) {
    return bad_input(where, "the camera's image has no sensible size", "calibrate the camera again");
  }
  for (const double value : {fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2, k3}) {
    if (!std::isfinite(value)) {
      return bad_input(where, "a number of the camera is not finite", "calibrate the camera again");
    }
  }
  if (!(fx_px > 0) || !(fy_px > 0)) {
    return bad_input(where, "the camera has no focal length", "calibrate the camera again");
  }
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector2d pixel((width - 1.0) * i / kSteps, (height - 1.0) * k / kSteps);
      if (!undistort(pixel)) {
        return bad_input(where,
                         "the lens distortion folds the image over at pixel " +
                             std::to_string(std::lround(pixel.x())) + ", " +
                             std::to_string(std::lround(pixel.y())),
                         "calibrate the camera again, with the board in every corner of its picture");
      }
    }
  }
  return {};
}

}  // namespace dubsar
