// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/rigid_transform.h"
#include "sim/tablet.h"

namespace dubsar::sim {

/// What an operator leaves before the scanner: four fingers over one half of the tablet, a gloved hand flat
/// over all of it, the fingers that hold it by its edge, or nothing at all, the tablet being gone.
enum class Disturbance { kNone, kHand, kGlove, kGrip, kGone };

/// What stands there instead of the tablet, in the tablet frame. A hand is as large as hands are, lies on the
/// tablet on the side of the scanner, and is a solid of its own that may cut into the tablet's. A grip: a
/// thumb on the face that is turned to the scanner, two fingers under the other; at another edge each `turn`.
/// Gone: a grain far under the support, so that there is something to shoot rays at.
[[nodiscard]] SimTablet disturbed(const SimTablet& tablet, const RigidTransform& tablet_from_scanner,
                                  Disturbance what, int turn = 0);

}  // namespace dubsar::sim
