// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar::testing {

/// ASCII Stanford range grids, just enough for real scans in tests; the program's own reader is formats/.
/// mm_per_unit scales the file's numbers.
[[nodiscard]] std::optional<RangeGrid> read_range_ply(const std::filesystem::path& path, double mm_per_unit);

/// `bmesh NAME tx ty tz qx qy qz qw` lines of a .conf: model_from_scanner by file name. The quaternions there
/// are conjugate to what takes scan points into the model.
[[nodiscard]] std::map<std::string, RigidTransform> read_conf(const std::filesystem::path& path,
                                                              double mm_per_unit);

/// $DUBSAR_DATA, or ../shared/data beside the sources; nothing where there is no such folder.
[[nodiscard]] std::optional<std::filesystem::path> data_folder();

/// The range grids of a folder in name order.
[[nodiscard]] std::vector<RangeGrid> read_folder(const std::filesystem::path& folder, double mm_per_unit);

}  // namespace dubsar::testing
