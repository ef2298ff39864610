// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/scan_pose.h"
#include "python/binding.h"

namespace dubsar::python {

/// "grid 3 (scan_003.ply)", for people.
[[nodiscard]] std::string grid_name(const std::vector<GridPointer>& grids, int place);

/// The poses with the places of their grids as ids. Where each pose has a file that is the source of just one
/// grid, the names tell which grid it is of, whatever the order of either list; else the ids do. Raises
/// UsageError where there is no such grid, where two poses are of one, and where the ids tell and a pose has
/// the name of another grid than its own.
[[nodiscard]] std::vector<ScanPose> paired_poses(std::vector<ScanPose> poses,
                                                 const std::vector<GridPointer>& grids);

}  // namespace dubsar::python
