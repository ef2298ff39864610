// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar::bench {

/// The longest side of the triangles whose samples the peers' figures for the bunny count: four times the
/// spacing of its rows. They are 358 359 of its 362 272 samples; most of the others lie at steps.
inline constexpr float kPeersLongestSideMm = 2.0F;

/// [valid samples, in their order]: 1 for those of a triangle without a longer side, of squares that are cut
/// along the shorter diagonal and of squares with one corner missing.
[[nodiscard]] std::vector<std::uint8_t> surface_samples(const RangeGrid& grid, float longest_side_mm);

}  // namespace dubsar::bench
