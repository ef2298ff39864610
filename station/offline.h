// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <vector>

#include "core/job.h"
#include "core/placed_scan.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "station/scan_set.h"

namespace dubsar {

/// Registers all scans of the set from nothing, in order, with a final relaxation.
[[nodiscard]] Result<std::vector<ScanPose>> register_scans(const ScanSet& set, JobContext& job);

/// The poses for `plan` and `stitch`: those of the file when one is named (matched by the scans' file names,
/// else by id), those of the session when it has any, else a registration.
[[nodiscard]] Result<std::vector<ScanPose>> poses_for(const ScanSet& set,
                                                      const std::filesystem::path& poses_file,
                                                      JobContext& job);

/// The registered scans in their places. Refers to the set.
[[nodiscard]] std::vector<PlacedScan> placed_scans(const ScanSet& set, const std::vector<ScanPose>& poses);

}  // namespace dubsar
