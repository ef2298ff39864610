// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/placed_scan.h"
#include "core/scan_pose.h"
#include "station/view_gain.h"

namespace dubsar {

/// What a page says of how well the scans agree, of how far their samples scatter and of how well the planner
/// foresaw them. Nothing is said of what was not measured: one scan alone agrees with no other.
/// poses: of the scans that count; placed: those in the model.
[[nodiscard]] std::vector<std::string> accuracy_sentences(const std::vector<ScanPose>& poses,
                                                          std::span<const PlacedScan> placed,
                                                          const std::vector<ViewGain>& gains);

}  // namespace dubsar
