// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "planning/pin_layout.h"

namespace dubsar {

/// Pins that may be chosen: tips before points of the rim, at the gap from the hull, each with the arm along
/// the tip's way out, level, or between. Mirror images of each other for a body that is its own mirror image.
[[nodiscard]] std::vector<PlannedPin> rim_candidates(const TabletHull& hull, double rim_radius_mm,
                                                     const PinLayoutOptions& options);

/// Indices of the chosen candidates. Fewer than options.count when no more keep their distance.
[[nodiscard]] std::vector<std::size_t> search_pins(const TabletHull& hull,
                                                   const std::vector<PlannedPin>& candidates,
                                                   const PinLayoutOptions& options, const JobContext& job);

}  // namespace dubsar
