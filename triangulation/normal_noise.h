// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "triangulation/grid_triangulation.h"

namespace dubsar {

/// Noise of one sample along the surface's normal, mm, as far as the grid tells: from fourth differences of
/// samples with keep != 0 across the rows, by their median. Across, because what speckle does to neighbours
/// of one profile is much the same, and no difference along the row shows it; fourth ones, because on a
/// coarse grid second ones hold more of the tablet's shape than of the noise. At most half the spacing;
/// nothing where too few samples stand in a column.
[[nodiscard]] std::optional<double> noise_along_normal_mm(const GridSurface& surface,
                                                          std::span<const std::uint8_t> keep);

}  // namespace dubsar
