// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/frame_target.h"

#include <cmath>

namespace dubsar::sim {

namespace {

constexpr double kFarMm = 2000;
constexpr double kOwnSurfaceMm = 0.01;  // nearer than this a shadow is the surface's own rounding
constexpr double kBlack = 0.06;
constexpr double kWhite = 0.8;
constexpr double kSurroundings = 0.02;

}  // namespace

std::optional<SceneHit> SceneTarget::hit(const Eigen::Vector3d& origin_mm,
                                         const Eigen::Vector3d& direction) const {
  std::optional<SceneHit> hit =
      first_hit(scene_, tablet_from_camera_ * origin_mm, tablet_from_camera_.rotation * direction, kFarMm);
  if (hit) {
    hit->normal = tablet_from_camera_.rotation.transpose() * hit->normal;
  }
  return hit;
}

bool SceneTarget::blocked(const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm) const {
  return sim::blocked(scene_, tablet_from_camera_ * a_mm, tablet_from_camera_ * b_mm, kOwnSurfaceMm);
}

std::optional<SceneHit> BoardTarget::hit(const Eigen::Vector3d& origin_mm,
                                         const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d from =
      camera_from_board_.rotation.transpose() * (origin_mm - camera_from_board_.translation_mm);
  const Eigen::Vector3d along = camera_from_board_.rotation.transpose() * direction;
  if (!(along.z() > 1e-6)) {  // from behind
    return std::nullopt;
  }
  const double distance = -from.z() / along.z();
  if (!(distance > 0)) {
    return std::nullopt;
  }
  const double u = (from.x() + distance * along.x() + origin_mm_.x()) / mm_per_texel_;
  const double v = (from.y() + distance * along.y() + origin_mm_.y()) / mm_per_texel_;
  SceneHit out;
  out.distance_mm = distance;
  out.normal = -camera_from_board_.rotation.col(2);
  const bool on_board = u >= 0 && v >= 0 && u < pattern_.width && v < pattern_.height;
  if (!on_board) {
    out.albedo = kSurroundings;
    return out;
  }
  const int value = pattern_.at(static_cast<int>(u), static_cast<int>(v));
  out.albedo = kBlack + (kWhite - kBlack) * value / 255.0;
  return out;
}

}  // namespace dubsar::sim
