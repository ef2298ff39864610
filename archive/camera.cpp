// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/camera.h"

#include <Eigen/Geometry>

namespace dubsar {

namespace {

Eigen::Matrix3d view(const Eigen::Vector3d& right, const Eigen::Vector3d& up) {
  Eigen::Matrix3d m;
  m.row(0) = right;
  m.row(1) = up;
  m.row(2) = right.cross(up);
  return m;
}

}  // namespace

const char* view_file_stem(Face face) {
  switch (face) {
    case Face::kTop:
      return "01_top";
    case Face::kLeft:
      return "02_left";
    case Face::kObverse:
      return "03_front";
    case Face::kRight:
      return "04_right";
    case Face::kBottom:
      return "05_bottom";
    case Face::kReverse:
      break;
  }
  return "06_back";
}

ViewCamera face_camera(Face face, const RigidTransform& tablet_from_model) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d view_from_tablet = view(x, y);
  switch (face) {
    case Face::kObverse:
      break;
    case Face::kReverse:
      view_from_tablet = view(x, -y);
      break;
    case Face::kLeft:
      view_from_tablet = view(z, y);
      break;
    case Face::kRight:
      view_from_tablet = view(-z, y);
      break;
    case Face::kTop:
      view_from_tablet = view(x, -z);
      break;
    case Face::kBottom:
      view_from_tablet = view(x, z);
      break;
  }
  return {view_from_tablet * tablet_from_model.rotation, to_string(face)};
}

ViewCamera free_camera(const Eigen::Vector3d& towards_viewer, const Eigen::Vector3d& up) {
  Eigen::Vector3d back = Eigen::Vector3d::UnitZ();
  if (towards_viewer.allFinite() && towards_viewer.norm() > 0) {
    back = towards_viewer.normalized();
  }
  Eigen::Vector3d across =
      up.allFinite() ? Eigen::Vector3d(up - back * back.dot(up)) : Eigen::Vector3d::Zero();
  if (across.norm() <= 1e-9 * up.norm() || across.norm() == 0) {
    across = back.unitOrthogonal();
  }
  across.normalize();
  return {view(across.cross(back), across), "free"};
}

}  // namespace dubsar
