// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/result.h"

namespace dubsar {

/// A camera with central projection and the lens distortion of Brown and Conrady, as OpenCV writes it. Camera
/// frame: origin in the centre of projection, x to the right of the image, y down, z along the view.
struct CameraModel {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  ///< radial, radial, tangential, tangential, radial

  /// Distorted image coordinates of a point with z > 0, camera frame.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_mm) const;
  /// The same for normalised coordinates (x/z, y/z).
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& normalised) const;
  /// Normalised coordinates (x/z, y/z) of the ray through an image point: the distortion is undone by
  /// Newton's method. Nothing where the model folds over, which is outside of any image it was fitted to.
  [[nodiscard]] std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool sees(const Eigen::Vector2d& pixel, double margin_px = 0) const {
    return pixel.x() >= -0.5 + margin_px && pixel.x() <= width - 0.5 - margin_px &&
           pixel.y() >= -0.5 + margin_px && pixel.y() <= height - 0.5 - margin_px;
  }
  /// Errors (kBadInput): no size, no focal length, numbers that are not finite, or a distortion that folds
  /// over inside the image.
  [[nodiscard]] Status check(const std::string& where) const;
};

}  // namespace dubsar
