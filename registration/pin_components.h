// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// What parts one thing from another in a grid.
struct SheetOptions {
  double spacing_mm = 0.1;  ///< µ, > 0
  double noise_mm = 0.0;    ///< of a sample along the ray
  /// Neighbours farther apart than this many µ are on two things; so are those farther apart than half as
  /// many when neither side's slope leads to the other.
  double step_factor = 4.0;
  int least_cells = 4;  ///< smaller components are left to be loose
};

/// A part of the grid in which the scan goes from cell to cell without a depth step.
struct SheetComponent {
  std::size_t cells = 0;  ///< whole cells (2×2 samples, all four joined)
  int first_row = 0, last_row = 0, first_col = 0, last_col = 0;  ///< of its samples
};

struct Sheets {
  std::vector<SheetComponent> components;  ///< in the order of their first cell
  std::vector<std::int32_t> label;         ///< [rows*cols], index into components, -1: loose or invalid
};

/// Parts the grid at its depth steps. Two samples hang together when a chain of whole cells joins them, so
/// that a single sample between two surfaces (a mixed pixel) bridges nothing.
[[nodiscard]] Sheets part_at_steps(const RangeGrid& grid, const SheetOptions& options);

/// True when no square of more than `side` samples fits into the component.
[[nodiscard]] bool is_thin(const Sheets& sheets, const RangeGrid& grid, std::size_t component, int side);

/// [components], 1 for large ones (large[c] != 0) and whatever a chain of components, no farther than
/// reach_mm from each other, connects with one. Looks at a part of the samples only: a distance may come out
/// larger by a quarter of the reach.
[[nodiscard]] std::vector<std::uint8_t> connected_with_large(const Sheets& sheets, const RangeGrid& grid,
                                                             const std::vector<std::uint8_t>& large,
                                                             double reach_mm, double spacing_mm);

/// The component's samples in row order.
[[nodiscard]] std::vector<std::uint32_t> samples_of(const Sheets& sheets, const RangeGrid& grid,
                                                    std::size_t component);

}  // namespace dubsar
