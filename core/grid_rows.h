// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/range_grid.h"

namespace dubsar {

/// `count` rows from row `first` on, with all else as it stands in the grid but for the view, which is as at
/// the first of them.
[[nodiscard]] RangeGrid rows_of(const RangeGrid& grid, int first, int count);
/// The rows below the others; a grid without a row takes all of the other. False, and nothing is changed,
/// when the two are not as wide or do not have the same arrays.
bool append_rows(RangeGrid& grid, const RangeGrid& rows);

}  // namespace dubsar
