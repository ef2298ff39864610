// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "core/red_map.h"
#include "planning/view_candidates.h"

namespace dubsar {

/// Of the views that need no hands, at least least_tilt_rad off the vertical, the one from which most of what
/// was seen already is looked at steeply enough to be sampled well. It ties scans together: it is worth
/// taking before a tablet is first lifted, of which only one side was seen, and after a scan that had too
/// little in common with the others. predicted_cleared_mm2 is left at 0: it is not taken for what it clears.
/// Nothing when the rig has no such view, or nothing was seen.
[[nodiscard]] std::optional<NextView> side_view(const Rig& rig, const StageState& state,
                                                const PlacedScan& last, const ModelSurface& surface,
                                                double least_tilt_rad);

}  // namespace dubsar
