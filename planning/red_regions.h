// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "core/red_map.h"
#include "planning/red_targets.h"

namespace dubsar {

/// Grid neighbours farther apart than this are rims of two holes, or of the object itself.
inline constexpr double kRegionGridReachMm = 5.0;

/// Connected patches of red and of excused targets, largest first. A region's area is that of its holes: the
/// gaps between the red samples, and the part of the closing surface (the model's convex hull) that they
/// border, which stands for what nobody has seen. Centre and normal are means by area; the face is where most
/// of the area faces. A place above 20 mm² that goes round edges of the tablet is one region for each side of
/// which it takes in 10 mm² and a tenth of itself; what is left goes with the largest.
[[nodiscard]] std::vector<RedRegion> red_regions(const RedTargets& red, std::span<const PlacedScan> scans,
                                                 const ModelSurface& surface);

}  // namespace dubsar
