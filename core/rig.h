// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// A measurement of a certified artefact that showed how true the calibration is.
struct CalibrationCheck {
  std::string when;      ///< ISO 8601, as the rig tells it
  std::string artefact;  ///< what was measured
  double error_mm = 0;   ///< largest deviation from its certificate
};

/// What the rig can see and reach. The stage frame: origin at the turntable's centre on the support plane, z
/// up. The scanner frame: origin at the centre of the measuring volume, x along a profile, y along the
/// motion, z towards the scanner.
struct Rig {
  std::string name;
  ScannerView view;            ///< of a grid in its own frame; laser and camera positions at the middle row
  double spacing_mm = 0.1;     ///< lateral spacing µ
  double field_x_mm = 60;      ///< width of a profile
  double field_y_mm = 60;      ///< travel of the motion
  double depth_range_mm = 60;  ///< of z, centred on 0
  bool has_turntable = false;  ///< full turn about stage z, by motor
  double tilt_min_rad = 0;     ///< tilt of the scanner's axis from the vertical, by motor
  double tilt_max_rad = 0;
  bool hand_turns = true;        ///< the operator can lay the tablet on another side
  double support_height_mm = 0;  ///< nothing below this stage height can be seen
  std::string calibration;       ///< what it was calibrated with; empty when unknown
  std::optional<double> calibration_age_days;
  std::optional<CalibrationCheck> calibration_check;  ///< the last one; nothing when the rig tells none
};

/// Where the tablet lies: which way its model frame is turned on the stage. `name` is for people ("reverse
/// up").
struct HandPose {
  std::string name;
  RigidTransform stage_from_model;
};

/// A placement of tablet and scanner that the rig can be asked for.
struct Placement {
  double turntable_rad = 0;
  double tilt_rad = 0;
  /// Set when the tablet has to be turned by hand first: the rotation asked for, tablet_new_from_tablet_old
  /// in the stage frame, about the tablet's centre.
  std::optional<RigidTransform> hand_turn;
};

/// stage_from_scanner for a placement: the scanner looks at the point focus_mm of the stage, tilted from the
/// vertical towards -y, with the turntable turned by turntable_rad (the tablet turns, so the scanner goes the
/// other way round).
[[nodiscard]] RigidTransform stage_from_scanner(double turntable_rad, double tilt_rad,
                                                const Eigen::Vector3d& focus_mm);

}  // namespace dubsar
