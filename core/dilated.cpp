// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/dilated.h"

#include <algorithm>
#include <cstddef>

#include "core/parallel.h"

namespace dubsar {

std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marks, int height, int width, int radius) {
  std::vector<std::uint8_t> along(marks.size(), 0);
  std::vector<std::uint8_t> out(marks.size(), 0);
  const auto rows = static_cast<std::size_t>(height);
  const auto cols = static_cast<std::size_t>(width);
  const auto reach = static_cast<std::size_t>(std::max(radius, 0));
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        for (std::size_t c = 0; c < cols; ++c) {
          if (marks[r * cols + c] != 0) {
            const std::size_t begin = r * cols + (c > reach ? c - reach : 0);
            const std::size_t end = r * cols + std::min(c + reach + 1, cols);
            std::fill(along.begin() + static_cast<std::ptrdiff_t>(begin),
                      along.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
          }
        }
      },
      16);
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        std::uint8_t* const to = &out[r * cols];
        for (std::size_t q = r > reach ? r - reach : 0; q < std::min(r + reach + 1, rows); ++q) {
          const std::uint8_t* const from = &along[q * cols];
          for (std::size_t c = 0; c < cols; ++c) {
            to[c] |= from[c];
          }
        }
      },
      16);
  return out;
}

}  // namespace dubsar
