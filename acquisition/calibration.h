// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/calibration_mirror.h"
#include "acquisition/calibration_views.h"
#include "core/rig_calibration.h"

namespace dubsar {

struct CalibrationOptions {
  BoardSpec board;
  /// Nothing: the camera alone, or camera and laser, are calibrated.
  std::optional<MotionKind> motion;
  double depth_range_mm = 40;
  double plate_margin_mm = 0;  ///< of flat plate around the print, on which the stripe counts too
  /// A calibration worse than these is refused.
  double most_corner_px = 1.0;
  double most_stage_px = 1.0;  ///< corners of the board on the stage from where the stage puts them
  double most_stripe_px = 1.0;
  double most_focal_share = 0.005;  ///< standard deviation of the focal length over its value
  double most_volume_sigma_um = 50;
  /// A slide's millimetre, measured by the board, less 1: from `wanted` on it is told, beyond `most` refused.
  double wanted_stage_scale = 0.005;
  double most_stage_scale = 0.05;
  double most_turntable_axis_rad = 0.0175;  ///< standard deviation of its direction: 1°
  double wanted_mirror_axis_rad =
      0.035;  ///< of a galvanometer: 2°; known less well, it asks for more pictures
};

/// What was found, and what the pictures still lack.
struct CalibrationReport {
  RigCalibration rig;
  std::optional<MirrorAdvice>
      mirror;  ///< of a galvanometer whose axis is not known well enough; in `missing` too
  std::vector<std::string> missing;  ///< what to do next, most useful first; empty when nothing is missing
};

/// Camera, laser plane and stage from views of a board, refined together. Views without stripes calibrate the
/// camera alone. Errors (kBadInput): the pictures do not determine the rig or contradict it, with the reason
/// and what to do.
[[nodiscard]] Result<CalibrationReport> calibrate_rig(const std::vector<CalibrationView>& views,
                                                      const CalibrationOptions& options);

/// Which poses of the board are missing: parts of the picture where no corner was, sides that it was not
/// tilted to, and (with stripes) depths and sides of the volume where the stripe was never seen on it; also
/// how much of `depth_range_mm` the picture does not hold.
[[nodiscard]] std::vector<std::string> missing_poses(const std::vector<CalibrationView>& views,
                                                     const Intrinsics& intrinsics, const BoardSpec& board,
                                                     const Plane* laser, double plate_margin_mm = 0,
                                                     double depth_range_mm = 0);

}  // namespace dubsar
