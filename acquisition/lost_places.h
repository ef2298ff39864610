// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/scan_pose.h"

namespace dubsar::session {

/// `now` and, of `before`, the poses of the scans that are lost (by id): nobody can register those anew. They
/// stay where they lay beside the others: just there where a scan lies as it did, else moved with the first
/// that is registered in both. Where there is none, what is known of their place is lost: kFailed, with the
/// reason. By id.
[[nodiscard]] std::vector<ScanPose> with_lost_places(std::vector<ScanPose> now,
                                                     const std::vector<ScanPose>& before,
                                                     const std::vector<int>& lost);

}  // namespace dubsar::session
