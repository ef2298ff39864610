// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rig_calibration.h"

#include <Eigen/Geometry>
#include <cmath>

namespace dubsar {

namespace {

RigidTransform turn_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& point_mm, double angle_rad) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
  return {turn, point_mm - turn * point_mm};
}

}  // namespace

std::optional<double> Plane::along(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& direction) const {
  const double slope = normal.dot(direction);
  if (std::abs(slope) < 1e-12) {
    return std::nullopt;
  }
  return -signed_distance_mm(origin_mm) / slope;
}

Plane transformed(const RigidTransform& to_from, const Plane& plane) {
  const Eigen::Vector3d normal = to_from.rotation * plane.normal;
  return {normal, plane.distance_mm + normal.dot(to_from.translation_mm)};
}

RigidTransform RigMotion::zero_from_camera(double position) const {
  switch (kind) {
    case MotionKind::kLinear:
      return {Eigen::Matrix3d::Identity(), position * direction};
    case MotionKind::kTurntable:
      return turn_about(direction, axis_point_mm, -position);
    case MotionKind::kGalvanometer:
      break;
  }
  return {};
}

Plane RigMotion::laser_at(const Plane& at_zero, double position) const {
  if (kind != MotionKind::kGalvanometer) {
    return at_zero;
  }
  return transformed(turn_about(direction, axis_point_mm, position), at_zero);
}

RigidTransform RigCalibration::scanner_from_camera() const {
  const Eigen::Vector3d view{0, 0, 1};
  const double reach = laser.along(Eigen::Vector3d::Zero(), view).value_or(working_distance_mm);
  // In the plane, across the view: that is the way the stripe runs through the image.
  Eigen::Vector3d x = laser.normal.cross(view);
  x = x.norm() > 1e-9 ? x.normalized() : Eigen::Vector3d::UnitX();
  Eigen::Vector3d y = laser.normal;
  const bool linear = motion.kind == MotionKind::kLinear;
  if ((linear ? motion.direction.dot(y) : y.z()) < 0) {
    y = -y;
  }
  Eigen::Vector3d z = x.cross(y);
  if (z.z() > 0) {  // has to point back towards the camera
    z = -z;
    x = -x;
  }
  RigidTransform camera_from_scanner;
  camera_from_scanner.rotation << x, y, z;
  camera_from_scanner.translation_mm = reach * view;
  return camera_from_scanner.inverse();
}

ScannerView RigCalibration::view(double step, double position) const {
  const RigidTransform scanner = scanner_from_camera();
  ScannerView out;
  out.camera_mm = scanner.translation_mm;
  out.laser_mm =
      laser_source_mm ? scanner * *laser_source_mm : Eigen::Vector3d{0, 0, scanner.translation_mm.norm()};
  out.direction = -out.camera_mm->normalized();
  const RigidTransform there = scanner * motion.zero_from_camera(position) * scanner.inverse();
  out.camera_mm = there * *out.camera_mm;
  out.laser_mm = there * *out.laser_mm;
  out.direction = there.rotation * out.direction;
  if (motion.kind == MotionKind::kLinear) {
    out.motion_per_row_mm = scanner.rotation * (step * motion.direction);
  }
  return out;
}

double RigCalibration::field_per_px_mm() const {
  const double reach =
      laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()).value_or(working_distance_mm);
  return reach / camera.fx_px;
}

double RigCalibration::row_spacing_mm(double step) const {
  switch (motion.kind) {
    case MotionKind::kLinear:
      return step * motion.direction.norm();
    case MotionKind::kTurntable:
      return step * 0.25 * depth_range_mm;
    case MotionKind::kGalvanometer:
      break;
  }
  const Eigen::Vector3d middle(0, 0, working_distance_mm);
  return step * motion.direction.cross(middle - motion.axis_point_mm).norm();
}

double RigCalibration::depth_per_px_mm() const {
  const RigidTransform camera_from_scanner = scanner_from_camera().inverse();
  const Eigen::Vector2d low = camera.project(camera_from_scanner * Eigen::Vector3d(0, 0, -0.5));
  const Eigen::Vector2d high = camera.project(camera_from_scanner * Eigen::Vector3d(0, 0, 0.5));
  return 1.0 / (high - low).norm();  // whichever way the stripe runs
}

Status RigCalibration::check(const std::string& where) const {
  if (Status status = camera.check(where); !status) {
    return status;
  }
  const auto wrong = [&](const char* what) { return bad_input(where, what, "calibrate the rig again"); };
  if (!has_laser) {
    return {};
  }
  if (!laser.normal.allFinite() || std::abs(laser.normal.norm() - 1) > 1e-6 ||
      !std::isfinite(laser.distance_mm)) {
    return wrong("the laser plane is none");
  }
  const auto reach = laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  if (!reach || !(*reach > 0) || *reach > 1e5) {
    return wrong("the laser plane does not cross the camera's view");
  }
  if (std::abs(laser.distance_mm) < 1e-3 * *reach) {
    return wrong("the laser plane runs through the camera, so that no depth can be seen");
  }
  if (!has_motion) {
    return {};
  }
  const double length = motion.direction.norm();
  const bool linear = motion.kind == MotionKind::kLinear;
  if (!motion.direction.allFinite() || !motion.axis_point_mm.allFinite() ||
      !(linear ? length > 1e-3 && length < 1e3 : std::abs(length - 1) < 1e-6)) {
    return wrong("the direction of the stage is none");
  }
  if (linear && std::abs(motion.direction.dot(laser.normal)) < 0.05 * length) {
    return wrong("the stage moves along the laser plane, so that it never gets anywhere");
  }
  return {};
}

}  // namespace dubsar
