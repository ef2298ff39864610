// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <vector>

#include "acquisition/session_store.h"
#include "core/scan_pose.h"

namespace dubsar {

/// The scans that stand, can be read and have no pose at all, by id: the program that stored them ended
/// before it had worked out where they lie, or is still at it.
[[nodiscard]] inline std::vector<int> unplaced_scans(const std::vector<StoredScan>& scans,
                                                     const std::vector<ScanPose>& poses) {
  std::vector<int> out;
  for (const StoredScan& scan : scans) {
    if (!scan.dropped && !scan.damaged && std::ranges::find(poses, scan.id, &ScanPose::id) == poses.end()) {
      out.push_back(scan.id);
    }
  }
  return out;
}

}  // namespace dubsar
