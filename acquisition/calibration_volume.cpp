// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_volume.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rig_calibration.h"

namespace dubsar {

namespace {

/// Points that the rig would measure, as a function of the unknowns (9 of the camera, 3 of the laser, 3 of a
/// linear stage): pixels over the picture and the depth range, with the stage at both ends of 40 mm.
Eigen::VectorXd measured(const CameraModel& size, const Eigen::VectorXd& unknowns,
                         const std::vector<Eigen::Vector2d>& pixels, bool linear) {
  const Eigen::VectorXd& x = unknowns;
  const CameraModel model{size.width, size.height, x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]};
  const Eigen::Vector3d laser = unknowns.segment<3>(9);
  constexpr double kHalfTravelMm = 20;
  const int stops = linear ? 2 : 1;
  Eigen::VectorXd out(3 * stops * static_cast<Eigen::Index>(pixels.size()));
  Eigen::Index at = 0;
  for (int stop = 0; stop < stops; ++stop) {
    for (const Eigen::Vector2d& pixel : pixels) {
      const Eigen::Vector2d ray = model.undistort(pixel).value_or(Eigen::Vector2d::Zero());
      const Eigen::Vector3d direction(ray.x(), ray.y(), 1);
      Eigen::Vector3d p = direction / laser.dot(direction);
      if (linear) {
        p += (2 * stop - 1) * kHalfTravelMm * unknowns.segment<3>(12);
      }
      out.segment<3>(at) = p;
      at += 3;
    }
  }
  return out;
}

}  // namespace

double volume_sigma_mm(const CameraModel& camera, const Eigen::VectorXd& unknowns,
                       const Eigen::MatrixXd& joint, bool linear, double depth_range_mm) {
  const Eigen::Index count = linear ? 15 : 12;
  RigCalibration rig;
  rig.camera = camera;
  const Eigen::Vector3d laser = unknowns.segment<3>(9);
  rig.laser = {laser.normalized(), 1 / laser.norm()};
  const RigidTransform camera_from_scanner = rig.scanner_from_camera().inverse();
  const double half_field = 0.5 * camera.width * rig.field_per_px_mm();
  std::vector<Eigen::Vector2d> pixels;
  for (const double x : {-0.9, -0.45, 0.0, 0.45, 0.9}) {
    for (const double z : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const Eigen::Vector2d pixel =
          rig.camera.project(camera_from_scanner * Eigen::Vector3d(x * half_field, 0, z * depth_range_mm));
      if (rig.camera.sees(pixel)) {
        pixels.push_back(pixel);
      }
    }
  }
  const Eigen::VectorXd points = measured(camera, unknowns, pixels, linear);
  Eigen::MatrixXd slope(points.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double step = 1e-6 * std::max(1e-3, std::abs(unknowns[i]));
    Eigen::VectorXd up = unknowns;
    Eigen::VectorXd down = unknowns;
    up[i] += step;
    down[i] -= step;
    slope.col(i) =
        (measured(camera, up, pixels, linear) - measured(camera, down, pixels, linear)) / (2 * step);
  }
  // Less the rigid motion of all points that comes nearest: three shifts, three turns about their middle.
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(points.size(), 6);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const Eigen::Index n = points.size() / 3;
  for (Eigen::Index i = 0; i < n; ++i) {
    middle += points.segment<3>(3 * i) / static_cast<double>(n);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d arm = points.segment<3>(3 * i) - middle;
    for (int axis = 0; axis < 3; ++axis) {
      rigid(3 * i + axis, axis) = 1;
      rigid.block<3, 1>(3 * i, 3 + axis) = Eigen::Vector3d::Unit(axis).cross(arm);
    }
  }
  slope -= rigid * rigid.colPivHouseholderQr().solve(slope);
  double worst = 0;
  const Eigen::MatrixXd spread = slope * joint.topLeftCorner(count, count);
  for (Eigen::Index i = 0; i < n; ++i) {
    worst = std::max(worst, spread.middleRows(3 * i, 3).cwiseProduct(slope.middleRows(3 * i, 3)).sum());
  }
  return std::sqrt(worst);
}

}  // namespace dubsar
