// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/lattice.h"

#include "core/parallel.h"

namespace dubsar {

void box_mean(std::vector<float>& values, const std::vector<std::uint8_t>& mask, int rows, int cols,
              int radius) {
  if (radius <= 0 || values.empty()) {
    return;
  }
  const auto width = static_cast<std::size_t>(cols);
  const auto height = static_cast<std::size_t>(rows);
  const auto r = static_cast<std::size_t>(radius);
  std::vector<float> sums(values.size());
  std::vector<std::uint16_t> counts(values.size());
  parallel_for_each_index(
      height,
      [&](std::size_t row) {
        const std::size_t base = row * width;
        double sum = 0;
        int count = 0;
        const auto add = [&](std::size_t col, int sign) {
          if (mask[base + col] != 0) {
            sum += sign * static_cast<double>(values[base + col]);
            count += sign;
          }
        };
        for (std::size_t col = 0; col < std::min(r, width); ++col) {
          add(col, 1);
        }
        for (std::size_t col = 0; col < width; ++col) {
          if (col + r < width) {
            add(col + r, 1);
          }
          if (col > r) {
            add(col - r - 1, -1);
          }
          sums[base + col] = static_cast<float>(sum);
          counts[base + col] = static_cast<std::uint16_t>(count);
        }
      },
      16);
  // Columns in strips that fit a cache line or two.
  parallel_chunks(width, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> sum(end - begin, 0);
    std::vector<int> count(end - begin, 0);
    const auto add = [&](std::size_t row, int sign) {
      for (std::size_t col = begin; col < end; ++col) {
        sum[col - begin] += sign * static_cast<double>(sums[row * width + col]);
        count[col - begin] += sign * counts[row * width + col];
      }
    };
    for (std::size_t row = 0; row < std::min(r, height); ++row) {
      add(row, 1);
    }
    for (std::size_t row = 0; row < height; ++row) {
      if (row + r < height) {
        add(row + r, 1);
      }
      if (row > r) {
        add(row - r - 1, -1);
      }
      for (std::size_t col = begin; col < end; ++col) {
        const int n = count[col - begin];
        values[row * width + col] =
            n > 0 ? static_cast<float>(sum[col - begin] / n) : 0.0F;
      }
    }
  });
}

}  // namespace dubsar
