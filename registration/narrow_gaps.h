// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

struct NarrowGapOptions {
  int most_across = 3;   ///< samples that a gap may miss
  int least_along = 24;  ///< neighbouring lines that it must run through
};

/// Which samples are missing from within the surface: [rows*cols], 1 in long straight gaps along rows or
/// columns such as a dead column of the camera or a dropped profile leaves; empty where there are none. The
/// clay does not end there, and nothing hides a part of the spot beside them. An outline, a depth step and
/// its shadow are no gaps, nor is what a wedge hides: a gap must run straight through many lines, and across
/// most of them the surface go straight on. `keep` tells which samples there are.
[[nodiscard]] std::vector<std::uint8_t> narrow_gaps(const RangeGrid& grid,
                                                    const std::vector<std::uint8_t>& keep,
                                                    const NarrowGapOptions& options);

/// Takes cells off `boundary` (grid_geometry()) whose surface goes on beyond the `hollow` cells beside them,
/// of which a gap is all there is. Neighbours farther apart than step_mm are on two sheets; across a gap, as
/// many times that.
void bridge_gaps(const RangeGrid& grid, const std::vector<std::uint8_t>& hollow, double step_mm,
                 std::vector<std::uint8_t>& boundary);

}  // namespace dubsar
