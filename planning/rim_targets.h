// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/placed_scan.h"
#include "planning/red_targets.h"
#include "planning/surface_cover.h"

namespace dubsar {

/// Red samples beside which nothing is missing are settled (excused as unneeded, with no area): those around
/// which the well-sampled surface goes on on all sides, and those that hang apart from it and from every rim,
/// which are strays. A group of samples too large for a stray (`largest_stray_mm2`) is never settled so.
void settle_closed(std::span<const PlacedScan> scans, const SurfaceCover& cover, double largest_stray_mm2,
                   RedTargets& red);

/// Adds the rims of the well-sampled surface that no red sample marks: two scans that see a hole up to the
/// same rim clear each other there. A rim shorter than the reach of the cover is none. The area of a hole is
/// that of its rim's polygon; a rim that goes round more than `widest_hole_mm` is the border of what was seen
/// so far, and counts as a strip.
void add_rim_targets(const SurfaceCover& cover, double widest_hole_mm, RedTargets& red);

}  // namespace dubsar
