// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/board.h"
#include "core/rig_calibration.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// One pose of the board: the picture with the laser off, and what was taken without touching it.
struct CalibrationView {
  BoardView board;
  /// The laser's stripe on this pose: image points along it, already without ambient light. May hold points
  /// beside the board; they are sorted out.
  std::vector<Eigen::Vector2d> stripe_px;
  std::string laser_picture;   ///< file that `stripe_px` was looked for in; empty when there is none
  double mirror_position = 0;  ///< of a galvanometer when the stripe was taken, radians
  /// Views of one name show the board lying still on the stage while the stage went to `stage_position`.
  std::string fixed;
  double stage_position = 0;  ///< mm or radians
};

/// What the pictures of a board say about the camera.
struct Intrinsics {
  CameraModel camera;
  std::vector<std::size_t> used;                  ///< indices of the views that agree
  std::vector<RigidTransform> camera_from_board;  ///< [used]
  double rms_px = 0;                              ///< over all corners that were used
  std::vector<std::string> left_out;              ///< name and reason
};

/// How many coefficients of distortion pictures of this width of view can tell: a narrow one shows no more
/// than the first radial one and the tangential two, and the others would only take up noise.
enum class DistortionTerms { kThree, kFour, kAll };
[[nodiscard]] DistortionTerms terms_for(const CameraModel& camera);

struct IntrinsicsOptions {
  std::size_t least_views = 4;
  /// A view whose corners are off by more than this times the median view, and by more than half a pixel, is
  /// left out. 0 keeps all.
  double outlier_factor = 3;
};

/// Camera and poses from views of one board (Zhang 2000, through OpenCV). A view that repeats an earlier one
/// (corners within 0.02 px, at the same position of mirror or stage) tells nothing and is left out. Errors
/// (kBadInput): too few views, pictures of different sizes, poses that leave the focal length open, residuals
/// beyond a pixel.
[[nodiscard]] Result<Intrinsics> find_intrinsics(const std::vector<CalibrationView>& views,
                                                 const IntrinsicsOptions& options = {});

}  // namespace dubsar
