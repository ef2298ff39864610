// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/scan_pose.h"

namespace dubsar {

/// What a person should know of the scan: why it is not registered, or what is wrong with it although it is;
/// mostly empty.
[[nodiscard]] inline const std::string& remark_of(const ScanPose& pose) {
  return pose.reason.empty() ? pose.warning : pose.reason;
}

}  // namespace dubsar
