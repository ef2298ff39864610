// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace dubsar::sim {

/// A place on the surface with its directions: u to the right of the writing, v up, n out of the clay;
/// right-handed.
struct SurfaceFrame {
  Eigen::Vector3d p_mm{0, 0, 0};
  Eigen::Vector3d n{0, 0, 1};
  Eigen::Vector3d u{1, 0, 0};
  Eigen::Vector3d v{0, 1, 0};
};

/// The smooth clay body before anything is written on it: |x/a|^p + |y/b|^p + |z/c|^q = 1 + unevenness, a
/// pillow with slightly convex faces and a rounded rim. Obverse +z, top edge +y, right edge +x.
class TabletBody {
 public:
  /// size_mm: width, height, thickness. unevenness_mm: amplitude of the hand-made lack of symmetry.
  TabletBody(const Eigen::Vector3d& size_mm, double unevenness_mm, std::uint64_t seed);

  /// Negative inside, with its gradient (per mm). Not a distance.
  [[nodiscard]] double value(const Eigen::Vector3d& p_mm, Eigen::Vector3d* gradient) const;
  /// The surface point reached from p by Newton steps along the gradient; p within a few mm of the surface.
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& p_mm) const;
  /// The surface point on the ray from the origin along the direction (the body is star-shaped).
  [[nodiscard]] Eigen::Vector3d radial(const Eigen::Vector3d& direction) const;
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p_mm) const;
  /// Distance of an inner point to the surface.
  [[nodiscard]] double depth_below(const Eigen::Vector3d& p_mm) const;
  /// A frame at the surface point nearest p with u as close as it can be to `right`.
  [[nodiscard]] SurfaceFrame frame_at(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& right) const;
  /// Goes along the surface by du to the right and dv up, straight ahead, carrying the directions along.
  [[nodiscard]] SurfaceFrame walk(const SurfaceFrame& from, double du_mm, double dv_mm) const;

  /// Goes along a line of writing: as walk(), but staying in the plane through `line` across its v, so that
  /// lines stay straight and parallel where the surface bends away.
  [[nodiscard]] SurfaceFrame walk_line(const SurfaceFrame& from, const SurfaceFrame& line,
                                       double du_mm) const;

  [[nodiscard]] const Eigen::Vector3d& half_size_mm() const { return half_; }
  /// The same body without its unevenness: symmetric about all three planes.
  [[nodiscard]] TabletBody even() const;

 private:
  struct Wave {
    Eigen::Vector3d k;
    double phase;
    double strength;
  };
  Eigen::Vector3d half_;
  double p_ = 4.5;
  double q_ = 2.4;
  int wave_count_ = 0;
  std::array<Wave, 6> waves_{};
};

}  // namespace dubsar::sim
