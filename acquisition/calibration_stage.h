// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "acquisition/calibration_laser.h"
#include "acquisition/calibration_views.h"
#include "core/rig_calibration.h"

namespace dubsar {

/// First values of a stage's direction or axis from the poses of a board that it carried. Errors (kBadInput):
/// fewer than three positions, or all the same.
[[nodiscard]] Result<StageMotion> stage_from_poses(MotionKind kind, const std::vector<CalibrationView>& views,
                                                   const Intrinsics& intrinsics);

struct MirrorFit {
  StageMotion motion;
  Plane laser;  ///< at mirror position 0
};

/// First values of a galvanometer's axis and its laser plane at position 0, from the planes at three
/// positions or more. Errors (kBadInput): too few of them.
[[nodiscard]] Result<MirrorFit> mirror_from_stripes(const std::vector<CalibrationView>& views,
                                                    const Intrinsics& intrinsics,
                                                    const std::vector<StripeSample>& stripes);

}  // namespace dubsar
