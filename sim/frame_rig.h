// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

#include "core/mesh.h"
#include "core/rig_calibration.h"
#include "core/units.h"

namespace dubsar::sim {

/// A rig as a museum would build it: an industrial camera looking down, a line laser beside it, both at the
/// same distance from the middle of the volume.
struct FrameRigOptions {
  int width = 2048;
  int height = 1088;
  double field_mm = 50;                 ///< across the image in the middle of the volume
  double distance_mm = 250;             ///< camera and laser from there
  double angle_rad = rad_from_deg(25);  ///< between the camera's axis and the laser's
  double k1 = -0.15;                    ///< radial distortion
  MotionKind motion = MotionKind::kLinear;
};

/// The truth of such a rig: what a calibration of it should find. Linear: the head moves across the laser
/// plane. Galvanometer: the mirror is the laser's source. Turntable: the axis lies in the laser plane along
/// the stripe, 20 mm behind the middle of the volume.
[[nodiscard]] RigCalibration frame_rig(const FrameRigOptions& options = {});

}  // namespace dubsar::sim
