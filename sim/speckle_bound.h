// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>
#include <numbers>

#include "core/rig_calibration.h"
#include "sim/frame_renderer.h"
#include "sim/frame_rig.h"

namespace dubsar::sim {

/// What speckle bounds the depth of a sample by, standard deviation in micrometres, however good the stripe
/// is found: C·λ / (2π sin u) on the object, sin u of the aperture as the object sees it, over the sine of
/// the angle between camera and laser (R. Dorsch, G. Häusler, J. Herrmann, Laser triangulation: fundamental
/// uncertainty in distance measurement, Applied Optics 33(7), 1994).
[[nodiscard]] inline double speckle_bound_um(const RigCalibration& rig, const FrameOptions& optics,
                                             const FrameRigOptions& size) {
  // The sensor stands at f (1 + m), m = f / (distance - f) or so: f from that and the calibrated distance.
  const double image_mm = rig.camera.fx_px * optics.pixel_um * 1e-3;
  const double focal_mm = image_mm / (1 + image_mm / size.distance_mm);
  const double sin_u = 0.5 * focal_mm / optics.f_number / size.distance_mm;
  return optics.speckle_contrast * optics.wavelength_um / (2 * std::numbers::pi * sin_u) /
         std::sin(size.angle_rad);
}

}  // namespace dubsar::sim
