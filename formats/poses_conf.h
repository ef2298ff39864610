// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/scan_pose.h"

namespace dubsar {

/// The poses of a Stanford alignment file (`.conf`), registered all, in the file's order and without ids: one
/// a line that reads "bmesh FILE tx ty tz qx qy qz qw" (or "mesh"), the translation in units of
/// `mm_per_unit`; other lines say nothing. The quaternion turns the model's axes into the scan's: it is
/// conjugated to take scan points into the model. Errors name the line.
[[nodiscard]] Result<std::vector<ScanPose>> parse_conf_poses(std::string_view text, const std::string& where,
                                                             double mm_per_unit);
[[nodiscard]] Result<std::vector<ScanPose>> read_conf_poses(const std::filesystem::path& path,
                                                            double mm_per_unit);

}  // namespace dubsar
