// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"
#include "core/sample_flags.h"

namespace dubsar {

/// What a cell of a range grid shows.
enum class CellState : std::uint8_t { kNone, kSampled, kRed };

/// A range grid as a picture, cell by cell, for people to watch it grow and to point at places in it: relief
/// lit from the upper left, and what is under-sampled. A skin gives it its colours.
struct GridPicture {
  /// So many rows before the newest may still change.
  static constexpr int kUnsettledRows = 3;

  int rows = 0;
  int cols = 0;
  std::vector<std::uint8_t> shade;  ///< [rows*cols] 0 dark … 255 bright
  std::vector<CellState> state;     ///< [rows*cols]

  /// Takes in the row that has just come, and looks again at those before it whose flags it may have changed.
  /// A row at or before the last one begins a new picture.
  void append(const RangeGrid& grid, const SampleFlags& flags, int row);
};

[[nodiscard]] GridPicture picture_of(const RangeGrid& grid, const SampleFlags& flags);

}  // namespace dubsar
