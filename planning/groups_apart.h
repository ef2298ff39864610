// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "core/red_map.h"
#include "core/scan_pose.h"

namespace dubsar {

/// The groups that the poses tell of (ScanPose::group_apart), and how each is joined to the model: as a rule
/// one side of a tablet was scanned, then the other, and nothing ties them together. What they look like to
/// each other nobody knows, so what is asked for is said of the model alone: three scans over its joining
/// edge, begun from the scan that shows that edge best. model: the scans that the poses register. Nothing
/// where none is registered.
[[nodiscard]] std::vector<GroupApart> groups_apart(std::span<const ScanPose> poses,
                                                   std::span<const PlacedScan> model);

}  // namespace dubsar
