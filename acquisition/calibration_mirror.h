// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>

#include "acquisition/calibration_views.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// How well a galvanometer's axis is known, radians. Its lean out of the laser's plane shows by the square of
/// the mirror's way only, so that a lean to either side fits nearly as well: what was found of it counts as
/// doubt beside the standard deviation of the linear fit.
[[nodiscard]] double mirror_axis_doubt_rad(const RigCalibration& rig, double sigma_rad);

/// What is still to be shown before a mirror's axis is known well enough.
struct MirrorAdvice {
  double from = 0, to = 0;  ///< of the mirror, radians: as far as the stripe stays in the picture
  int poses = 0;            ///< of the board, by turns at `from`, in the middle and at `to`
  std::string say;
};

/// Nothing when the axis is known to `wanted_rad`, or when more pictures of this rig would not tell more: the
/// mirror went all its way and the board was shown there often.
[[nodiscard]] std::optional<MirrorAdvice> missing_mirror_poses(const std::vector<CalibrationView>& views,
                                                               const Intrinsics& intrinsics,
                                                               const RigCalibration& rig, double doubt_rad,
                                                               double wanted_rad);

}  // namespace dubsar
