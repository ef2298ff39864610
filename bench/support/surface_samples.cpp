// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/surface_samples.h"

#include <array>
#include <cstddef>

namespace dubsar::bench {

std::vector<std::uint8_t> surface_samples(const RangeGrid& grid, float longest_side_mm) {
  std::vector<std::uint8_t> in_triangle(grid.size(), 0);
  const auto apart = [&](std::size_t i, std::size_t j) { return (grid.point(i) - grid.point(j)).norm(); };
  const auto add = [&](const std::array<std::size_t, 3>& t) {
    if (grid.valid[t[0]] != 0 && grid.valid[t[1]] != 0 && grid.valid[t[2]] != 0 &&
        apart(t[0], t[1]) < longest_side_mm && apart(t[1], t[2]) < longest_side_mm &&
        apart(t[2], t[0]) < longest_side_mm) {
      in_triangle[t[0]] = in_triangle[t[1]] = in_triangle[t[2]] = 1;
    }
  };
  const auto cols = static_cast<std::size_t>(grid.cols);
  for (std::size_t row = 0; row + 1 < static_cast<std::size_t>(grid.rows); ++row) {
    for (std::size_t a = row * cols; a + 1 < (row + 1) * cols; ++a) {
      const std::size_t b = a + 1;
      const std::size_t c = a + cols;
      const std::size_t d = c + 1;
      const bool whole = grid.valid[a] != 0 && grid.valid[b] != 0 && grid.valid[c] != 0 && grid.valid[d] != 0;
      const bool falling = whole && apart(a, d) <= apart(b, c);
      // With a corner missing only the triangle of the other three has all of its samples.
      if (!whole || falling) {
        add({a, b, d});
        add({a, d, c});
      }
      if (!falling) {
        add({a, b, c});
        add({b, d, c});
      }
    }
  }
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      out.push_back(in_triangle[i]);
    }
  }
  return out;
}

}  // namespace dubsar::bench
