// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/range_grid.h"

namespace dubsar {

/// The part of the grid's surface, by area, that looks another way than the rest as the scanner sees it: away
/// from the scanner, or towards it where rows and columns run the other way round. Next to 0 of a range grid,
/// for a scanner sees no back of anything; a half of one that goes round a body. Of some hundred thousand
/// facets; those across depth steps do not count. grid.spacing_mm must be > 0.
[[nodiscard]] double share_turned_away(const RangeGrid& grid);

}  // namespace dubsar
