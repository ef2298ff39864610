// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/orbit_camera.h"

#include <algorithm>
#include <cmath>

#include "core/tablet_sides.h"

namespace dubsar::ui {

namespace {

constexpr float kMargin = 1.06F;
constexpr float kNearestMm = 0.02F;
constexpr float kFarthestMm = 5000.0F;

/// On a ball in the middle of the picture, or on the hyperbola around it (Bell's trackball).
Eigen::Vector3f on_ball(const Eigen::Vector2f& at) {
  constexpr float kRadius = 0.8F;
  const float far2 = at.squaredNorm();
  const float z = far2 < kRadius * kRadius / 2 ? std::sqrt(kRadius * kRadius - far2)
                                               : kRadius * kRadius / 2 / std::sqrt(far2);
  return Eigen::Vector3f(at.x(), at.y(), z).normalized();
}

}  // namespace

Eigen::Quaternionf eye_towards(Face face, const RigidTransform& tablet_from_model) {
  const SideAxes& side = side_axes(face);
  Eigen::Matrix3d eye_from_tablet;
  eye_from_tablet.row(0) = side.right.transpose();
  eye_from_tablet.row(1) = side.up().transpose();
  eye_from_tablet.row(2) = side.normal.transpose();
  return Eigen::Quaternionf(Eigen::Matrix3f((eye_from_tablet * tablet_from_model.rotation).cast<float>()))
      .normalized();
}

void OrbitCamera::fit(const Eigen::AlignedBox3f& box, float aspect) {
  if (box.isEmpty()) {
    return;
  }
  centre_mm = box.center();
  Eigen::AlignedBox3f eye;
  for (int k = 0; k < 8; ++k) {
    eye.extend(eye_from_model * (box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)) - centre_mm));
  }
  half_height_mm = std::max(kNearestMm, kMargin * 0.5F * std::max(eye.sizes().y(), eye.sizes().x() / aspect));
  depth_mm = std::max(kNearestMm, box.diagonal().norm());
}

void OrbitCamera::drag(const Eigen::Vector2f& from, const Eigen::Vector2f& to) {
  const Eigen::Quaternionf turn = Eigen::Quaternionf::FromTwoVectors(on_ball(from), on_ball(to));
  eye_from_model = (turn * eye_from_model).normalized();
}

void OrbitCamera::pan(const Eigen::Vector2f& by_px, float height_px) {
  const float mm = mm_per_px(height_px);
  centre_mm += eye_from_model.conjugate() * Eigen::Vector3f(-by_px.x() * mm, by_px.y() * mm, 0);
}

void OrbitCamera::zoom(float factor, const Eigen::Vector2f& at, float aspect) {
  const float before = half_height_mm;
  half_height_mm = std::clamp(half_height_mm * factor, kNearestMm, kFarthestMm);
  const float moved = before - half_height_mm;
  centre_mm += eye_from_model.conjugate() * Eigen::Vector3f(at.x() * aspect * moved, at.y() * moved, 0);
}

Eigen::Matrix4f OrbitCamera::clip_from_model(float aspect) const {
  Eigen::Matrix4f clip = Eigen::Matrix4f::Identity();
  const Eigen::Vector3f scale(1 / (half_height_mm * aspect), 1 / half_height_mm, -1 / depth_mm);
  const Eigen::Matrix3f turn = eye_from_model.toRotationMatrix();
  clip.topLeftCorner<3, 3>() = scale.asDiagonal() * turn;
  clip.topRightCorner<3, 1>() = -(clip.topLeftCorner<3, 3>() * centre_mm);
  return clip;
}

Eigen::Vector2f OrbitCamera::pixel_of(const Eigen::Vector3f& point_mm, const Eigen::Vector2f& size_px) const {
  const Eigen::Vector3f eye = eye_from_model * (point_mm - centre_mm);
  const float px_per_mm = size_px.y() / (2 * half_height_mm);
  return {0.5F * size_px.x() + eye.x() * px_per_mm, 0.5F * size_px.y() - eye.y() * px_per_mm};
}

}  // namespace dubsar::ui
