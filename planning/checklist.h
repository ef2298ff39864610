// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/checklist.h"
#include "core/mesh.h"
#include "core/placed_scan.h"
#include "core/rig.h"
#include "core/scan_pose.h"
#include "planning/surface_quality.h"

namespace dubsar {

/// Six faces with what was seen, how well, and what is missing; how the scans registered; what the rig says
/// of its calibration. `registered` and `mesh` (the stitched model, model frame; interpolated vertices count
/// as not seen) may be empty. A copy that the map names counts as the scan that it is of, whether it is among
/// `registered` or not, and has a warning that says so. Disk, integrity and sign-off are the session's to
/// fill in.
[[nodiscard]] Checklist make_checklist(const RedMap& map, std::span<const ScanPose> poses,
                                       std::span<const PlacedScan> registered, const Mesh& mesh,
                                       const Rig* rig);

}  // namespace dubsar
