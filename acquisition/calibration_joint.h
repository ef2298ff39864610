// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "acquisition/calibration_laser.h"
#include "acquisition/calibration_views.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// What the joint refinement starts from, and what it leaves behind.
struct JointState {
  CameraModel camera;
  std::vector<RigidTransform>
      camera_from_board;  ///< [Intrinsics::used]; of a fixed board: as it was seen there
  Plane laser;            ///< at mirror position 0
  RigMotion motion;
  bool has_laser = false;
  bool has_stage = false;
};

struct JointErrors {
  double corner_rms_px = 0;
  double stripe_rms_px = 0;
  double stripe_rms_mm = 0;
  double stage_rms_px = 0;  ///< corners of fixed boards from where the stage puts them
  double stage_rms_mm = 0;
  double focal_sigma_px = 0;
  /// Of a point in the measuring volume against the others: the largest, after the rigid motion of the whole
  /// that no measurement can see has been taken out. Contains camera, laser plane, and a slide or
  /// a turntable over a part of its way (volume_sigma_mm).
  double volume_sigma_mm = 0;
  double axis_sigma_rad = 0;
};

/// Minimises over all at once: corners against camera and poses, poses of a fixed board tied together by the
/// stage, stripe samples against the laser plane; each in pixels over its own scatter, with Huber's loss.
/// Standard deviations come from the covariance at the minimum. Errors (kBadInput): the pictures leave
/// something open (the covariance is singular).
[[nodiscard]] Result<JointErrors> refine_jointly(const std::vector<CalibrationView>& views,
                                                 const std::vector<std::size_t>& used,
                                                 const std::vector<StripeSample>& stripes,
                                                 double depth_range_mm, JointState& state);

}  // namespace dubsar
