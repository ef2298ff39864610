// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

double estimate_noise_mm(const RangeGrid& grid, const std::vector<std::uint8_t>& keep) {
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  const auto near2 = static_cast<float>(9.0 * spacing_mm * spacing_mm);
  const Eigen::Vector3f view = grid.view.direction.cast<float>();
  // Some ten thousand differences settle a median.
  const std::size_t stride = std::max<std::size_t>(1, grid.size() / 60000);
  std::vector<float> bends;
  for (std::size_t i = 0; i < grid.size(); i += stride) {
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    if (!grid.is_valid(row, col) || !grid.is_valid(row, col - 1) || !grid.is_valid(row, col + 1) ||
        (!keep.empty() && (keep[i] == 0 || keep[i - 1] == 0 || keep[i + 1] == 0))) {
      continue;
    }
    const Eigen::Vector3f a = grid.point(i - 1) - grid.point(i);
    const Eigen::Vector3f b = grid.point(i + 1) - grid.point(i);
    if (a.squaredNorm() <= near2 && b.squaredNorm() <= near2) {
      bends.push_back(std::abs(view.dot(a + b)));
    }
  }
  if (bends.empty()) {
    return 0.0;
  }
  // A second difference has sqrt(6) times the noise of a sample.
  return std::min(kSigmaOfMedian * static_cast<double>(median_of(std::move(bends))) / std::sqrt(6.0),
                  0.5 * spacing_mm);
}

}  // namespace dubsar
