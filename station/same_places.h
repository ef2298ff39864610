// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/rigid_transform.h"
#include "core/scan_pose.h"

namespace dubsar {

/// Whether the two are the same but for the rounding of their doubles: a pose that went to another frame and
/// back comes out with other last digits.
[[nodiscard]] bool is_same_place(const RigidTransform& a, const RigidTransform& b);

/// The poses, each with the place that `shown` has for its scan where the two are the same: to the digit what
/// was written down, and what was made of it.
[[nodiscard]] std::vector<ScanPose> as_shown(std::vector<ScanPose> poses, const std::vector<ScanPose>& shown);

}  // namespace dubsar
