// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "core/scan_pose.h"

namespace dubsar::session {

/// A pose with everything that registration knows of it, as the session keeps it: numbers come back bit for
/// bit.
[[nodiscard]] std::string json_from_pose(const ScanPose& pose);
[[nodiscard]] Result<ScanPose> pose_from_json(int id, std::string_view json);

}  // namespace dubsar::session
