// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "planning/red_targets.h"
#include "planning/surface_cover.h"

namespace dubsar {

/// Excuses the red of what hangs apart from the tablet (unneeded, with no area): what the mask left of a
/// pin's arm, a thread. Of a piece as large as a chip the area and the size are told. A solid has one closed
/// surface, so that clay which no well-sampled surface joins to the rest is joined to it through a hole. A
/// piece (well-sampled surface and the red samples beside it) that lies farther from every hole than laser
/// and camera see into one as wide is no clay. Holes are those of the cover and the places that red samples
/// mark; a piece that lies near one counts as clay, and its own holes count too. So nothing is excused while
/// a large border is open. A piece of more than a fiftieth of the largest may be a second body and counts as
/// clay.
///
/// Returns, by hole of the cover, 1 where it is in a piece that is no clay.
[[nodiscard]] std::vector<std::uint8_t> excuse_apart(std::span<const PlacedScan> scans,
                                                     const SurfaceCover& cover, RedTargets& red);

}  // namespace dubsar
