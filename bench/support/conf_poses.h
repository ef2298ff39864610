// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/rigid_transform.h"

namespace dubsar::bench {

/// The published poses of a Stanford scan set by file name, model_from_scanner. Its lines are "bmesh FILE tx
/// ty tz qx qy qz qw"; the quaternion has to be conjugated to take scan points into the model. Lines that are
/// none of this are skipped; a file that cannot be read gives nothing.
[[nodiscard]] std::map<std::string, RigidTransform> read_conf_poses(const std::filesystem::path& path,
                                                                    double mm_per_file_unit);

}  // namespace dubsar::bench
