// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/scan_pose.h"

namespace dubsar::testing {

/// One scan's error against the published pose, after one rigid gauge alignment of all registered scans.
/// shift_mm is that of the scan's own centroid.
struct GaugeError {
  ScanPose pose;
  double turn_rad = 0;
  double shift_mm = 0;
};

/// `truth` by file name; `grids` by scan id. Errors of scans that are not registered, or not in `truth`, are
/// infinite.
[[nodiscard]] std::vector<GaugeError> gauge_errors(
    const std::vector<ScanPose>& poses, const std::map<std::string, RigidTransform>& truth,
    const std::vector<std::shared_ptr<const RangeGrid>>& grids);

}  // namespace dubsar::testing
