// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// Noise of one sample along the view, mm: from the second differences of neighbours in a row, by their
/// median, so that relief and steps hardly count. At most half the spacing; 0 where nothing can be told. Only
/// samples with keep[i] != 0 count when `keep` is not empty.
[[nodiscard]] double estimate_noise_mm(const RangeGrid& grid, const std::vector<std::uint8_t>& keep = {});

}  // namespace dubsar
