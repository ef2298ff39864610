// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "acquisition/calibration_views.h"
#include "core/camera_model.h"
#include "core/gray_image.h"
#include "core/result.h"
#include "core/rig_calibration.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// A turntable with four markers on a circle, as a photograph shows it.
struct MarkedTable {
  RigidTransform camera_from_table;  ///< origin in the middle, z the normal
  double circle_mm = 0;              ///< radius on which the markers' middles lie, as found
  double rms_px = 0;                 ///< of the markers' corners

  [[nodiscard]] Plane top() const {
    const Eigen::Vector3d normal = camera_from_table.rotation.col(2);
    return {normal, normal.dot(camera_from_table.translation_mm)};
  }
};

/// The poses of boards as a given camera sees them. Only so may what lies on them be compared with a plane in
/// that camera's frame: another camera model from other pictures of the same lens has its principal point,
/// and with it all poses, some pixels aside.
[[nodiscard]] Intrinsics seen_by(const CameraModel& camera, const std::vector<CalibrationView>& views);

/// Finds the table by its ArUco markers (4×4, `marker_mm` wide, a quarter turn apart). How far from the
/// middle they lie is found too: only their width is taken on trust. Errors (kBadInput): not four markers.
[[nodiscard]] Result<MarkedTable> find_marked_table(const GrayImage& image, const CameraModel& camera,
                                                    double marker_mm);

/// Where a stripe's pixels lie on a plane, camera frame; those within `radius_mm` of `middle_mm`.
[[nodiscard]] std::vector<Eigen::Vector3d> stripe_on_plane(const std::vector<Eigen::Vector2d>& stripe_px,
                                                           const CameraModel& camera, const Plane& plane,
                                                           const Eigen::Vector3d& middle_mm,
                                                           double radius_mm);

/// How a plane of light and a stripe that it should have made lie to each other.
struct StripeMiss {
  double median_mm = 0;  ///< of its points' distances from the plane: a stray one in a few does not count
  double angle_rad = 0;  ///< between the stripe, which should be a line, and the plane: free of any scale
};
[[nodiscard]] StripeMiss miss(const Plane& light, const std::vector<Eigen::Vector3d>& stripe_mm);

/// The pixels where a plane of light would cross another plane, within `radius_mm` of `middle_mm`.
[[nodiscard]] std::vector<Eigen::Vector2d> crossing_px(const Plane& light, const Plane& plane,
                                                       const CameraModel& camera,
                                                       const Eigen::Vector3d& middle_mm, double radius_mm);

}  // namespace dubsar
