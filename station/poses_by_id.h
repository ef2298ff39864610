// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <vector>

#include "core/scan_pose.h"
#include "station/station_scan.h"

namespace dubsar {

/// Whether the names that the poses of a file have may all be foreign to the scans of a plain folder (or
/// file): none is that of a file there. Grids and PLY may still have one of them as their original name.
[[nodiscard]] bool may_have_other_names(const std::vector<ScanPose>& file,
                                        const std::filesystem::path& scans);

/// Poses of a file none of which is of one of these scans by its name lose their names, with a warning, where
/// each scan has the number of just one of them: then the numbers tell. Else they stay as they are. The scans
/// are those of a plain folder; their numbers and names are looked at alone.
void let_numbers_tell(const std::vector<StationScan>& scans, const std::filesystem::path& poses_file,
                      std::vector<ScanPose>* file);

}  // namespace dubsar
