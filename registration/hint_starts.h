// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/pose_hint.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// Poses (on_from_scanner) to start from, given what the operator said. Three or more points: the pose that
/// they give. Two: turns about the line through them, around what the surface's normals say. One: point on
/// point, normal against normal, and every turn about it. A rough pose: itself and small turns about it.
/// Empty when the hint is none (check_point_pairs).
[[nodiscard]] std::vector<RigidTransform> starts_from_hint(const PoseHint& hint, const ScanSurface& scan,
                                                           const ScanSurface& on);

}  // namespace dubsar
