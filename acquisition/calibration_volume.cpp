// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_volume.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rig_calibration.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kHalfTravelMm = 20;
constexpr double kHalfTurnRad = rad_from_deg(30);

/// Points that the rig would measure, as a function of the unknowns (9 of the camera, 3 of the laser, 3 of
/// the stage's direction, 3 of a point of its axis): pixels over the picture and the depth range, with the
/// stage at both ends of its way, where it has one.
Eigen::VectorXd measured(const CameraModel& size, const Eigen::VectorXd& unknowns,
                         const std::vector<Eigen::Vector2d>& pixels, std::optional<MotionKind> stage) {
  const Eigen::VectorXd& x = unknowns;
  const CameraModel model{size.width, size.height, x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]};
  const Eigen::Vector3d laser = unknowns.segment<3>(9);
  const bool linear = stage == MotionKind::kLinear;
  const bool turns = stage == MotionKind::kTurntable;
  const Eigen::Vector3d direction_of_stage = unknowns.segment<3>(12);
  const Eigen::Vector3d axis_point = unknowns.segment<3>(15);
  const int stops = linear || turns ? 2 : 1;
  Eigen::VectorXd out(3 * stops * static_cast<Eigen::Index>(pixels.size()));
  Eigen::Index at = 0;
  for (int stop = 0; stop < stops; ++stop) {
    for (const Eigen::Vector2d& pixel : pixels) {
      const Eigen::Vector2d ray = model.undistort(pixel).value_or(Eigen::Vector2d::Zero());
      const Eigen::Vector3d direction(ray.x(), ray.y(), 1);
      Eigen::Vector3d p = direction / laser.dot(direction);
      if (linear) {
        p += (2 * stop - 1) * kHalfTravelMm * direction_of_stage;
      } else if (turns) {
        const Eigen::AngleAxisd turn((2 * stop - 1) * kHalfTurnRad, direction_of_stage.normalized());
        p = axis_point + turn * (p - axis_point);
      }
      out.segment<3>(at) = p;
      at += 3;
    }
  }
  return out;
}

RigCalibration rig_of(const CameraModel& camera, const Plane& laser) {
  RigCalibration rig;
  rig.camera = camera;
  rig.laser = laser;
  return rig;
}

/// How much of the way from (x, 0, 0) to (x, 0, z) of the scanner's frame is in the picture: 0 to 1, less
/// than 0 where its beginning is not.
double share_seen(const CameraModel& camera, const RigidTransform& camera_from_scanner, double x, double z) {
  const auto seen = [&](double share) {
    const Eigen::Vector3d p = camera_from_scanner * Eigen::Vector3d(x, 0, share * z);
    return p.z() > 0 && camera.sees(camera.project(p));
  };
  if (!seen(0)) {
    return -1;
  }
  if (seen(1)) {
    return 1;
  }
  double low = 0;
  double high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (seen(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

SeenDepth seen_depth(const CameraModel& camera, const Plane& laser, double depth_range_mm) {
  const RigidTransform camera_from_scanner = rig_of(camera, laser).scanner_from_camera().inverse();
  const double half = 0.5 * depth_range_mm;
  return {half * std::max(0.0, share_seen(camera, camera_from_scanner, 0, half)),
          half * std::max(0.0, share_seen(camera, camera_from_scanner, 0, -half))};
}

double volume_sigma_mm(const CameraModel& camera, const Eigen::VectorXd& unknowns,
                       const Eigen::MatrixXd& joint, std::optional<MotionKind> stage, double depth_range_mm) {
  constexpr Eigen::Index kCount = 18;
  const Eigen::Vector3d laser = unknowns.segment<3>(9);
  const RigCalibration rig = rig_of(camera, {laser.normalized(), 1 / laser.norm()});
  const RigidTransform camera_from_scanner = rig.scanner_from_camera().inverse();
  const double half_field =
      0.5 * (runs_down(rig.laser) ? camera.height : camera.width) * rig.field_per_px_mm();
  std::vector<Eigen::Vector2d> pixels;
  for (const double x : {-0.9, -0.45, 0.0, 0.45, 0.9}) {
    for (const double z : {-0.5, 0.5}) {
      const double share = share_seen(camera, camera_from_scanner, x * half_field, z * depth_range_mm);
      for (const double part : {0.0, 0.5, 1.0}) {
        if (share >= 0 && (part > 0 || z > 0)) {  // what both ways begin with, once
          pixels.push_back(camera.project(
              camera_from_scanner * Eigen::Vector3d(x * half_field, 0, part * share * z * depth_range_mm)));
        }
      }
    }
  }
  const Eigen::VectorXd points = measured(camera, unknowns, pixels, stage);
  Eigen::MatrixXd slope(points.size(), kCount);
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const double step = 1e-6 * std::max(1e-3, std::abs(unknowns[i]));
    Eigen::VectorXd up = unknowns;
    Eigen::VectorXd down = unknowns;
    up[i] += step;
    down[i] -= step;
    slope.col(i) = (measured(camera, up, pixels, stage) - measured(camera, down, pixels, stage)) / (2 * step);
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
  const Eigen::MatrixXd spread = slope * joint;
  for (Eigen::Index i = 0; i < n; ++i) {
    worst = std::max(worst, spread.middleRows(3 * i, 3).cwiseProduct(slope.middleRows(3 * i, 3)).sum());
  }
  return std::sqrt(worst);
}

}  // namespace dubsar
