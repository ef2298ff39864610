// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <vector>

#include "core/result.h"
#include "core/scan_pose.h"

namespace dubsar {

/// A Stanford alignment file, which says no unit: it is in its scans'.
[[nodiscard]] bool is_conf(const std::filesystem::path& poses_file);

/// Millimetres per unit of the numbers in the files of these poses, as they state it (obj_info unit of a
/// PLY); 1 where they state none. `scans` is the folder that they lie in, or the file. kBadInput where they
/// differ.
[[nodiscard]] Result<double> mm_per_unit_of_scans(const std::filesystem::path& scans,
                                                  const std::vector<ScanPose>& poses);

}  // namespace dubsar
