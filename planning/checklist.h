// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/checklist.h"
#include "core/mesh.h"
#include "core/placed_scan.h"
#include "core/rig.h"
#include "core/scan_pose.h"

namespace dubsar {

/// Six faces with what was seen and what is missing, and how the scans registered. `registered` and `mesh`
/// (the stitched model, model frame; interpolated vertices count as not seen) may be empty. Disk and
/// integrity are the session's to fill in.
[[nodiscard]] Checklist make_checklist(const RedMap& map, std::span<const ScanPose> poses,
                                       std::span<const PlacedScan> registered, const Mesh& mesh,
                                       const Rig* rig);

}  // namespace dubsar
