// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// The neighbours that a sample's own surface goes on to.
template <class Visit>
void for_each_link(const RangeGrid& grid, std::size_t i, float longest_mm, const Visit& visit) {
  const int row = grid.row_of(i);
  const int col = grid.col_of(i);
  for (int k = 0; k < 9; ++k) {
    const int r = row + k / 3 - 1;
    const int c = col + k % 3 - 1;
    if (k == 4 || !grid.is_valid(r, c)) {
      continue;
    }
    const std::size_t j = grid.index(r, c);
    if ((grid.point(j) - grid.point(i)).norm() <= longest_mm) {
      visit(j);
    }
  }
}

/// Parts that hang together of what `enter` lets in, as far as they begin with a sample that `begin` holds
/// for.
template <class Begin, class Enter>
std::vector<std::vector<std::size_t>> linked_parts(const RangeGrid& grid, float longest_mm,
                                                   const Begin& begin, const Enter& enter) {
  std::vector<std::vector<std::size_t>> out;
  std::vector<std::uint8_t> visited(grid.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (visited[i] != 0 || grid.valid[i] == 0 || !begin(i)) {
      continue;
    }
    std::vector<std::size_t>& part = out.emplace_back(1, i);
    visited[i] = 1;
    for (std::size_t k = 0; k < part.size(); ++k) {
      for_each_link(grid, part[k], longest_mm, [&](std::size_t j) {
        if (visited[j] == 0 && enter(j)) {
          visited[j] = 1;
          part.push_back(j);
        }
      });
    }
  }
  return out;
}

}  // namespace dubsar
