// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/placed_scan.h"
#include "planning/clearing.h"
#include "planning/red_targets.h"

namespace dubsar {

/// Which targets of an earlier red map a new scan has cleared, [targets], and their area: what its predicted
/// gain is to be held against. A target of red samples counts when a non-flagged sample of the scan lies
/// within the clearing radius of them; an unseen patch when the scan's surface lies behind it, met from
/// outside. mm², in the areas of the earlier map. scan.flags: of the scan, as flag_sparse() gives them or
/// later.
[[nodiscard]] std::vector<std::uint8_t> cleared_targets(const RedTargets& before, const PlacedScan& scan,
                                                        const ClearingOptions& options = {});
[[nodiscard]] double cleared_area_mm2(const RedTargets& before, const PlacedScan& scan,
                                      const ClearingOptions& options = {});

}  // namespace dubsar
