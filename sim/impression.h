// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/wedge.h"
#include "sim/body.h"

namespace dubsar::sim {

/// One press of the stylus, in the plane of a surface frame: where the depth point's foot lies and where the
/// three corners of the outline lie as seen from that foot, counter-clockwise; corner 0 is the tail.
struct Stroke {
  Eigen::Vector2d foot_mm{0, 0};
  std::array<Eigen::Vector2d, 3> corners_mm{};
  double depth_mm = 0.5;
};

/// A long wedge: a head of the given width, its tail length_mm away in the direction angle_rad (0 right, pi/2
/// up). head_slope_rad: slope of the head face.
[[nodiscard]] Stroke long_wedge(const Eigen::Vector2d& head_mm, double angle_rad, double length_mm,
                                double width_mm, double depth_mm, double head_slope_rad);
/// A Winkelhaken: the stylus' corner alone, its apex in the direction angle_rad.
[[nodiscard]] Stroke winkelhaken(const Eigen::Vector2d& middle_mm, double angle_rad, double size_mm,
                                 double depth_mm);

/// A wedge pressed into the body: three planes through the depth point, and the clay heaped up around it.
class Impression {
 public:
  /// Corners are laid on the body by walking from `origin`, so that a wedge can run over an edge.
  Impression(const TabletBody& body, const SurfaceFrame& origin, const Stroke& stroke, double dam_mm);

  /// Height of the clay over the base point p along its normal n after this press, from height_mm before it.
  /// `face` is set to the face that made the surface there, 0 to 2, or to -1 when this press made none.
  [[nodiscard]] double press(const Eigen::Vector3d& p, const Eigen::Vector3d& n, double height_mm,
                             int* face) const;
  /// Radius about centre_mm outside which press() changes nothing.
  [[nodiscard]] double reach_mm() const { return reach_mm_; }
  [[nodiscard]] const Eigen::Vector3d& centre_mm() const { return centre_; }
  [[nodiscard]] const Eigen::Vector3d& depth_point_mm() const { return depth_point_; }
  /// The free surface over the depth point, and its normal.
  [[nodiscard]] const Eigen::Vector3d& foot_mm() const { return foot_; }
  [[nodiscard]] const Eigen::Vector3d& normal() const { return normal_; }
  /// What a perfect measurement of an undisturbed impression would find.
  [[nodiscard]] Wedge truth(const TabletBody& body) const;

 private:
  [[nodiscard]] double outside_mm(const Eigen::Vector3d& p) const;

  Eigen::Vector3d foot_;
  Eigen::Vector3d depth_point_;
  Eigen::Vector3d normal_;
  Eigen::Vector3d centre_;
  std::array<Eigen::Vector3d, 3> exits_{};
  std::array<Eigen::Vector3d, 3> faces_{};  ///< unit, out of the clay; face k between edges k and k+1
  std::array<Eigen::Vector3d, 3> sides_{};  ///< unit, out of the outline across side k, along the surface
  double dam_mm_ = 0;
  double dam_width_mm_ = 0.3;
  double reach_mm_ = 0;
};

}  // namespace dubsar::sim
