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

/// From low to high, both included.
struct Range {
  double low = 0;
  double high = 0;
  [[nodiscard]] bool contains(double value, double slack = 0) const {
    return value >= low - slack && value <= high + slack;
  }
};

/// The body that carries laser and camera, a box in the scanner frame. Where it moves while it scans, the box
/// holds it from the first row to the last.
struct HeadBox {
  Eigen::Vector3d low_mm{0, 0, 0};
  Eigen::Vector3d high_mm{0, 0, 0};
  [[nodiscard]] Eigen::Vector3d middle_mm() const { return 0.5 * (low_mm + high_mm); }
};

/// How far an arm carries the scanner. All of it is said of the middle of the head's box.
struct RobotReach {
  Eigen::Vector3d base_mm{0, 0, 0};  ///< where the arm stands, stage frame
  Range reach_mm{0, 1e4};            ///< from there
  Range height_mm{0, 1e4};           ///< above the support
  Range standoff_mm{0, 1e4};         ///< from the origin of the stage
};

inline constexpr double kFullTurnRad = 6.283185307179586;
/// Larger angles of a turntable or tilt, ten turns, are a slip of the keyboard or no angles at all.
inline constexpr double kMostTurnRad = 10 * kFullTurnRad;

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
  bool hand_turns = true;        ///< the operator can lay the tablet on another side, or prop it
  double support_height_mm = 0;  ///< nothing below this stage height can be seen
  std::string calibration;       ///< what it was calibrated with; empty when unknown
  std::optional<double> calibration_age_days;
  /// Of the turntable: a full turn where it goes round and round, less where something stops it.
  Range turntable_rad{0, kFullTurnRad};
  /// Set when an arm carries the scanner anywhere: placements then have a free pose, whose axis is tilted
  /// within tilt_min_rad and tilt_max_rad.
  std::optional<RobotReach> robot;
  std::optional<HeadBox> head;  ///< not known without it; head_of() then guesses
  /// How near the head may come to what is known of the tablet.
  double keep_out_margin_mm = 15;

  [[nodiscard]] bool turns_fully() const {
    return turntable_rad.high - turntable_rad.low > kFullTurnRad - 1e-6;
  }
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
  /// in the stage frame, about the tablet's centre. The translation is where that centre then lies, seen from
  /// the middle of the stage, along the support, and how far above the middle of the scanner's depth: zero
  /// unless the tablet is larger than the field, or than the depth.
  std::optional<RigidTransform> hand_turn;
  /// stage_from_scanner as an arm is asked for it; turntable and tilt are 0 then.
  std::optional<RigidTransform> free_pose = std::nullopt;
};

/// stage_from_scanner for a placement: the scanner looks at the point focus_mm of the stage, tilted from the
/// vertical towards -y, with the turntable turned by turntable_rad (the tablet turns, so the scanner goes the
/// other way round).
[[nodiscard]] RigidTransform stage_from_scanner(double turntable_rad, double tilt_rad,
                                                const Eigen::Vector3d& focus_mm);

/// The same for any placement: an arm's free pose, or turntable and tilt about the focus.
[[nodiscard]] RigidTransform stage_from_scanner(const Placement& placement, const Eigen::Vector3d& focus_mm);

/// Angle of the scanner's axis from the vertical.
[[nodiscard]] double tilt_of(const Placement& placement);

/// A placement in a few words, for people: "turntable to 40°, tilt to 35°", "arm 40° off the vertical".
[[nodiscard]] std::string say_placement(const Rig& rig, const Placement& placement);

}  // namespace dubsar
