// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// Rows of one grid, ascending, each row beyond those before it on the stage's way.
using StagePass = std::vector<int>;

/// The rows of a grid by passes of the stage over the clay. A stage that stood still or moved back measures
/// again what it has measured: such rows are no neighbours of those that they follow, but lie over others as
/// those of another scan do, and belong to a pass of their own. The first pass takes all that goes on beyond
/// its last row; of what is left the next is made in the same way. A pass of a single row, which has no
/// surface, is left out. Nearly always there is one pass, of all rows; `spacing_mm` > 0.
///
/// That the stage moved back is seen by rows that follow each other the wrong way round, as the laser sees
/// them (the camera where the laser's place is not known); that it stood still, by rows that do neither and
/// lie over earlier ones. Rows with few samples in the same columns go with those before them.
[[nodiscard]] std::vector<StagePass> stage_passes(const RangeGrid& grid, double spacing_mm);

/// The rows of a pass as a grid, with the places that laser and camera had at its first row.
[[nodiscard]] RangeGrid grid_of_pass(const RangeGrid& grid, const StagePass& pass);

}  // namespace dubsar
