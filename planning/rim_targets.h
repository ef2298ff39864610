// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>

#include "core/placed_scan.h"
#include "planning/red_targets.h"
#include "planning/surface_cover.h"

namespace dubsar {

/// Red samples beside which nothing is missing are settled (excused as unneeded, with no area): those beside
/// well-sampled surface that goes on on all sides, and those of groups of no more than `most_stray_samples`
/// that hang apart from it and from every rim, which are strays. noise_mm: of a sample.
void settle_closed(std::span<const PlacedScan> scans, const SurfaceCover& cover, double noise_mm,
                   std::size_t most_stray_samples, RedTargets& red);

/// Adds the rims of the well-sampled surface that no red sample marks: two scans that see a hole up to the
/// same rim clear each other there. A rim shorter than the reach of the cover is none. The area of a hole is
/// that of its rim's polygon; a rim that goes round more than `widest_hole_mm` is the border of what was seen
/// so far, and counts as a strip. apart: by hole, 1 on those in which no clay is missing (excuse_apart());
/// empty: there are none.
void add_rim_targets(const SurfaceCover& cover, double widest_hole_mm, std::span<const std::uint8_t> apart,
                     RedTargets& red);

}  // namespace dubsar
