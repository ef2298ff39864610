// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/patch_shape.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "triangulation/grid_triangulation.h"

namespace dubsar {
namespace {

using Marks = std::vector<std::uint8_t>;

std::size_t count(const Marks& marks) {
  return static_cast<std::size_t>(std::ranges::count(marks, std::uint8_t{1}));
}

TEST(PatchShape, CornersOfCellsAreThoseOfTheirTriangles) {
  constexpr int kRows = 30, kCols = 41;
  std::mt19937 random(7);
  constexpr std::array<std::uint8_t, 7> kCodes = {
      0,
      kCellFirst,
      kCellSecond,
      kCellFirst | kCellSecond,
      kCellAntidiagonal | kCellFirst,
      kCellAntidiagonal | kCellSecond,
      kCellAntidiagonal | kCellFirst | kCellSecond,
  };
  Marks cells(std::size_t{kRows} * kCols, 0);
  Marks expected(cells.size(), 0);
  const GridSurface grid{kRows, kCols, 0.1, {}, {}, {}};
  for (int row = 0; row + 1 < kRows; ++row) {
    for (int col = 0; col + 1 < kCols; ++col) {
      const std::uint8_t cell = kCodes[random() % (random() % 2 == 0 ? 1 : kCodes.size())];
      cells[grid.index(row, col)] = cell;
      for (const int which : {0, 1}) {
        if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
          for (const std::size_t i : cell_triangle(grid, row, col, cell, which)) {
            expected[i] = 1;
          }
        }
      }
    }
  }
  EXPECT_EQ(corners_of_cells(cells, kRows, kCols), expected);
}

TEST(PatchShape, ScatteredSamplesAreDroppedGroupsAndAdditionsStay) {
  const Lattice grid(20, 20);
  Marks fresh(400, 0), kept(400, 0);
  const auto at = [](int row, int col) { return static_cast<std::size_t>(20 * row + col); };
  fresh[at(0, 0)] = fresh[at(0, 1)] = fresh[at(1, 1)] = 1;  // three in a corner
  fresh[at(5, 19)] = fresh[at(6, 0)] = 1;                   // at two ends of the grid: not beside each other
  for (int k = 0; k < 5; ++k) {
    fresh[at(10 + k, 3 + k)] = 1;  // five aslant
  }
  kept[at(15, 15)] = kept[at(15, 16)] = kept[at(16, 15)] = 1;
  fresh[at(14, 14)] = fresh[at(17, 16)] = 1;  // and these two make five with what is kept
  Marks all = fresh;
  drop_scattered(all, kept, grid, 5);
  EXPECT_EQ(count(all), 7U);
  EXPECT_EQ(all[at(12, 5)] & all[at(14, 14)] & all[at(17, 16)], 1);
  EXPECT_EQ(all[at(0, 1)] | all[at(5, 19)] | all[at(6, 0)], 0);
  Marks beside_none = fresh;
  drop_scattered(beside_none, {}, grid, 5);
  EXPECT_EQ(count(beside_none), 5U);
  EXPECT_EQ(beside_none[at(12, 5)], 1);
  drop_scattered(fresh, kept, grid, 6);
  EXPECT_EQ(count(fresh), 0U);
}

}  // namespace
}  // namespace dubsar
