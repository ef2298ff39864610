// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/range_grid.h"

namespace dubsar {

/// Noise of one sample along the view, mm: from the second differences of neighbours in a row, by their
/// median, so that relief and steps hardly count. At most half the spacing; 0 where nothing can be told.
[[nodiscard]] double estimate_noise_mm(const RangeGrid& grid);

}  // namespace dubsar
