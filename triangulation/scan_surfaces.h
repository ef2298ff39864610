// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/job.h"
#include "core/placed_scan.h"
#include "core/result.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

/// For people.
[[nodiscard]] std::string stitched_name(const PlacedScan& scan);

/// kBadInput when the scan has no grid, its arrays or flags have another size, its pose is not rigid or puts
/// it too far from the origin for float.
[[nodiscard]] Status check_stitchable(const PlacedScan& scan);

/// The surface of each pass of the scan's stage, one at the least, of a scan that check_stitchable() passed.
/// Of a job that is cancelled they are no good, and some are missing.
[[nodiscard]] std::vector<StitchSurface> surfaces_of_passes(const PlacedScan& scan,
                                                            const StitchSurfaceOptions& options,
                                                            const JobContext& job = {});

}  // namespace dubsar
