// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/scan_pose.h"

namespace dubsar {

/// poses.json, truth_poses.json and `register --json` (docs/formats/poses.md). A negative id is not written.
[[nodiscard]] std::string poses_to_json(std::span<const ScanPose> poses);
[[nodiscard]] Status write_poses(const std::filesystem::path& path, std::span<const ScanPose> poses);

/// Needs `file` or `id` (absent: -1) and `model_from_scanner` of every scan; what says no status is
/// registered. Errors name the value by its path, e.g. "scans[3].model_from_scanner is not a rigid
/// transform".
[[nodiscard]] Result<std::vector<ScanPose>> parse_poses(std::string_view text, const std::string& where);
[[nodiscard]] Result<std::vector<ScanPose>> read_poses(const std::filesystem::path& path);

}  // namespace dubsar
