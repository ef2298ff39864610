// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/red_map.h"
#include "core/rigid_transform.h"

namespace dubsar::ui {

/// From outside onto one side of a tablet, its top up.
[[nodiscard]] Eigen::Quaternionf eye_towards(Face face, const RigidTransform& tablet_from_model);

/// An orthographic look at a model, so that a millimetre is as long everywhere in the picture. Eye space: x
/// to the right, y up, z towards the viewer; lengths in mm.
struct OrbitCamera {
  Eigen::Quaternionf eye_from_model = Eigen::Quaternionf::Identity();
  Eigen::Vector3f centre_mm = Eigen::Vector3f::Zero();  ///< model point in the middle of the picture
  float half_height_mm = 30;                            ///< from the middle to the upper edge
  float depth_mm = 100;  ///< half of what is drawn in front of and behind the middle

  /// Shows all of the box, seen as it is turned now.
  void fit(const Eigen::AlignedBox3f& box, float aspect);
  /// Turns as if a ball were dragged, by parts of the picture's height.
  void drag(const Eigen::Vector2f& from, const Eigen::Vector2f& to);
  /// Moves the middle, by pixels of a picture that high.
  void pan(const Eigen::Vector2f& by_px, float height_px);
  /// Keeps the point under the pointer (in [-1, 1] of the picture) where it is.
  void zoom(float factor, const Eigen::Vector2f& at, float aspect);

  [[nodiscard]] Eigen::Matrix4f clip_from_model(float aspect) const;
  [[nodiscard]] float mm_per_px(float height_px) const { return 2 * half_height_mm / height_px; }
  /// Where a model point stands in a picture of that size, pixels from the top left.
  [[nodiscard]] Eigen::Vector2f pixel_of(const Eigen::Vector3f& point_mm,
                                         const Eigen::Vector2f& size_px) const;
  [[nodiscard]] bool operator==(const OrbitCamera& other) const {
    return eye_from_model.coeffs() == other.eye_from_model.coeffs() && centre_mm == other.centre_mm &&
           half_height_mm == other.half_height_mm && depth_mm == other.depth_mm;
  }
};

}  // namespace dubsar::ui
