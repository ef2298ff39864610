// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// The points p with normal·p = distance. `normal` is a unit vector.
struct Plane {
  Eigen::Vector3d normal{0, 0, 1};
  double distance_mm = 0;

  [[nodiscard]] double signed_distance_mm(const Eigen::Vector3d& p_mm) const {
    return normal.dot(p_mm) - distance_mm;
  }
  /// Where the ray origin + t·direction meets it, as t; nothing when it runs along the plane.
  [[nodiscard]] std::optional<double> along(const Eigen::Vector3d& origin_mm,
                                            const Eigen::Vector3d& direction) const;
};

/// The plane in another frame.
[[nodiscard]] Plane transformed(const RigidTransform& to_from, const Plane& plane);

enum class MotionKind {
  kLinear,        ///< a slide carries the head past the tablet, or the tablet past the head
  kGalvanometer,  ///< a mirror turns the laser plane; camera and tablet stand still
  kTurntable,     ///< the tablet turns in front of a head that stands still
};

/// How the stage moves. Everything is said in the camera frame; `position` is millimetres of a linear stage,
/// radians of the others.
struct RigMotion {
  MotionKind kind = MotionKind::kLinear;
  /// Linear: where the head goes, as seen from the tablet, when the position grows by 1 mm (its length is the
  /// scale of the stage's own millimetre). Others: the axis, a unit vector, right-handed turn of the mirror
  /// or of the table.
  Eigen::Vector3d direction{0, 1, 0};
  Eigen::Vector3d axis_point_mm{0, 0, 0};  ///< on the axis; of no meaning for a linear stage

  /// Takes what the camera sees at `position` to where it was (or would be) at position 0.
  [[nodiscard]] RigidTransform zero_from_camera(double position) const;
  /// The position whose view a scan over these has, in one frame: row 0 where the head is carried along, as
  /// the view says how it moves on; the middle where the tablet turns.
  [[nodiscard]] double view_position(double start, double end) const {
    return kind == MotionKind::kTurntable ? 0.5 * (start + end) : start;
  }
  /// The laser plane at `position`, camera frame, from the one at position 0.
  [[nodiscard]] Plane laser_at(const Plane& at_zero, double position) const;
};

/// How well a calibration fits what it was made from, and how far it is to be trusted.
struct CalibrationQuality {
  int board_views = 0;  ///< used; left out ones are in `left_out`
  int stripe_views = 0;
  int stage_positions = 0;
  double corner_rms_px = 0;   ///< reprojection, per corner
  double corner_rms_um = 0;   ///< the same on the board
  double stripe_rms_px = 0;   ///< stripe samples from the laser plane, in the image
  double stripe_rms_um = 0;   ///< the same, distance from the plane
  double stage_rms_um = 0;    ///< board corners from where the stage model puts them
  double focal_sigma_px = 0;  ///< standard deviation from the covariance of the joint refinement
  /// Standard deviation of a point in the measuring volume against the others, the largest: from the
  /// covariance of camera, laser plane and stage (a slide, over 40 mm; a turntable, over 30° to either side)
  /// together, less the rigid motion of the whole, which harms nothing. Of what the picture holds of the
  /// depth range.
  double volume_sigma_um = 0;
  double axis_sigma_rad = 0;          ///< of the stage's direction or axis
  std::vector<std::string> left_out;  ///< views that were not used, with the reason
};

/// What turns the pictures of one camera with one laser on one stage into millimetres. Made by `dubsar
/// calibrate`, kept in a file (docs/formats/calibration.md).
struct RigCalibration {
  CameraModel camera;
  std::string camera_serial;  ///< empty when not known
  Plane laser;                ///< camera frame, at stage position 0
  RigMotion motion;
  bool has_laser = true;   ///< else the camera alone is known
  bool has_motion = true;  ///< else the stage is not known
  /// Where the laser stands, camera frame, if somebody measured it: for shadows only, 10 mm do no harm.
  std::optional<Eigen::Vector3d> laser_source_mm;
  double working_distance_mm = 0;  ///< from the camera to the middle of the measuring volume
  double depth_range_mm = 0;       ///< of the volume, along the laser
  std::string made_at;             ///< ISO 8601, UTC
  std::optional<double> temperature_c;
  std::string note;
  CalibrationQuality quality;

  /// scanner_from_camera at stage position 0. The scanner frame lies in the laser plane: x along the profile,
  /// z in the plane towards the scanner, y across the plane the way the motion goes; origin where the
  /// camera's axis meets the laser plane.
  [[nodiscard]] RigidTransform scanner_from_camera() const;
  /// Laser and camera as they stand to what is seen at `position`, and what a row of `step` moves them by, in
  /// the scanner frame of position 0. A laser that nobody measured is taken as far away as the camera,
  /// straight above the origin.
  [[nodiscard]] ScannerView view(double step, double position = 0) const;
  /// Depth that moves the stripe by one pixel, and one pixel across the field, both in the middle of the
  /// volume.
  [[nodiscard]] double depth_per_px_mm() const;
  [[nodiscard]] double field_per_px_mm() const;
  /// From a row to the next, of a scan in steps of `step`, in the middle of the volume. On a turntable that
  /// is the axis itself: there, where clay lies off it by a quarter of the volume's depth, for want of a
  /// tablet; what one has is seen in its grid.
  [[nodiscard]] double row_spacing_mm(double step) const;
  /// Errors (kBadInput): a camera, plane or axis that cannot be; what is not known is not looked at.
  [[nodiscard]] Status check(const std::string& where) const;
};

}  // namespace dubsar
