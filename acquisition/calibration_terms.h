// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <ceres/jet.h>
#include <ceres/rotation.h>

#include "core/rig_calibration.h"

/// The residuals of the joint refinement, written so that Ceres can take their derivatives. The parameters:
/// camera: fx fy cx cy k1 k2 p1 p2 k3; pose: rotation vector and translation, camera_from_board; laser: the
/// plane's normal over its distance, so that q·p = 1 on it; stage: direction, and a point on the axis.
namespace dubsar::calibration_terms {

/// The same as CameraModel::distort.
template <class T>
void bend(const T* camera, const T& x, const T& y, T& u, T& v) {
  const T r2 = x * x + y * y;
  const T radial = T(1) + r2 * (camera[4] + r2 * (camera[5] + r2 * camera[8]));
  u = x * radial + T(2) * camera[6] * x * y + camera[7] * (r2 + T(2) * x * x);
  v = y * radial + camera[6] * (r2 + T(2) * y * y) + T(2) * camera[7] * x * y;
}

/// The ray through a pixel: fixed-point iteration, which carries the derivatives along.
template <class T>
void unbend(const T* camera, double pixel_u, double pixel_v, T* ray) {
  constexpr int kRounds = 12;
  const T u = (T(pixel_u) - camera[2]) / camera[0];
  const T v = (T(pixel_v) - camera[3]) / camera[1];
  T x = u;
  T y = v;
  for (int i = 0; i < kRounds; ++i) {
    T bent_u, bent_v;
    bend(camera, x, y, bent_u, bent_v);
    x += u - bent_u;
    y += v - bent_v;
  }
  ray[0] = x;
  ray[1] = y;
  ray[2] = T(1);
}

template <class T>
void place(const T* pose, const Eigen::Vector3d& p, T* out) {
  const T from[3] = {T(p.x()), T(p.y()), T(p.z())};
  ceres::AngleAxisRotatePoint(pose, from, out);
  for (int i = 0; i < 3; ++i) {
    out[i] += pose[3 + i];
  }
}

/// Turns p by `angle` about the axis direction through point.
template <class T>
void turn(const T* direction, const T* point, double angle, T* p) {
  const T vector[3] = {direction[0] * T(angle), direction[1] * T(angle), direction[2] * T(angle)};
  const T arm[3] = {p[0] - point[0], p[1] - point[1], p[2] - point[2]};
  T turned[3];
  ceres::AngleAxisRotatePoint(vector, arm, turned);
  for (int i = 0; i < 3; ++i) {
    p[i] = turned[i] + point[i];
  }
}

struct Corner {
  Eigen::Vector2d pixel;
  Eigen::Vector3d on_board_mm;
  double sigma_px;

  template <class T>
  bool finish(const T* camera, const T* p, T* residual) const {
    if (!(p[2] > T(1e-6))) {
      return false;
    }
    T u, v;
    bend(camera, T(p[0] / p[2]), T(p[1] / p[2]), u, v);
    residual[0] = (camera[0] * u + camera[2] - T(pixel.x())) / T(sigma_px);
    residual[1] = (camera[1] * v + camera[3] - T(pixel.y())) / T(sigma_px);
    return true;
  }
  template <class T>
  bool operator()(const T* camera, const T* pose, T* residual) const {
    T p[3];
    place(pose, on_board_mm, p);
    return finish(camera, p, residual);
  }
};

/// A corner of a board that the stage carried to `position`; pose is that at position 0.
struct CarriedCorner {
  Corner corner;
  MotionKind kind;
  double position;

  template <class T>
  bool operator()(const T* camera, const T* pose, const T* direction, const T* point, T* residual) const {
    T p[3];
    place(pose, corner.on_board_mm, p);
    if (kind == MotionKind::kLinear) {
      for (int i = 0; i < 3; ++i) {
        p[i] -= T(position) * direction[i];
      }
    } else {
      turn(direction, point, position, p);
    }
    return corner.finish(camera, p, residual);
  }
};

/// A stripe sample: the ray through it meets the board on the laser plane.
struct Stripe {
  Eigen::Vector2d pixel;
  double mirror;  // turns the plane by so much about the stage's axis
  double mm_per_px;
  double sigma_px;

  template <class T>
  bool meet(const T* camera, const T* pose, T* p) const {
    T ray[3];
    unbend(camera, pixel.x(), pixel.y(), ray);
    const T up[3] = {T(0), T(0), T(1)};
    T normal[3];
    ceres::AngleAxisRotatePoint(pose, up, normal);
    const T slope = normal[0] * ray[0] + normal[1] * ray[1] + normal[2] * ray[2];
    const T away = normal[0] * pose[3] + normal[1] * pose[4] + normal[2] * pose[5];
    for (int i = 0; i < 3; ++i) {
      p[i] = ray[i] * away / slope;
    }
    return true;
  }
  template <class T>
  bool finish(const T* p, const T* laser, T* residual) const {
    using std::sqrt;
    const T length = sqrt(laser[0] * laser[0] + laser[1] * laser[1] + laser[2] * laser[2]);
    const T off = (laser[0] * p[0] + laser[1] * p[1] + laser[2] * p[2] - T(1)) / length;
    residual[0] = off / T(mm_per_px * sigma_px);
    return true;
  }
  template <class T>
  bool operator()(const T* camera, const T* pose, const T* laser, T* residual) const {
    T p[3];
    return meet(camera, pose, p) && finish(p, laser, residual);
  }
  /// With a galvanometer: the point turned back to where the mirror stands at 0.
  template <class T>
  bool operator()(const T* camera, const T* pose, const T* laser, const T* direction, const T* point,
                  T* residual) const {
    T p[3];
    if (!meet(camera, pose, p)) {
      return false;
    }
    turn(direction, point, -mirror, p);
    return finish(p, laser, residual);
  }
};

/// The point on the axis may slide along it: held near where it began, with no weight to speak of.
struct AxisGauge {
  Eigen::Vector3d along;
  Eigen::Vector3d point_mm;
  template <class T>
  bool operator()(const T* point, T* residual) const {
    residual[0] = T(0);
    for (int i = 0; i < 3; ++i) {
      residual[0] += T(along[i]) * (point[i] - T(point_mm[i]));
    }
    return true;
  }
};

}  // namespace dubsar::calibration_terms
