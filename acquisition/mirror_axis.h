// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/rig_calibration.h"

namespace dubsar {

/// How far a point may be off for what is not known of a galvanometer's axis, mm, at the ends of the stripe
/// and as far as the mirror turns with the stripe in the picture: an axis that leans by `doubt_rad` more
/// turns the plane along the stripe by that times 1 - cos of the mirror's angle (Rodrigues' formula, of the
/// plane's normal).
[[nodiscard]] double mirror_axis_sigma_mm(const RigCalibration& rig, double doubt_rad);

}  // namespace dubsar
