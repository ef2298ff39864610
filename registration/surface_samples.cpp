// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// `count` of the indices in `from`, evenly spread over their order.
void take_spread(const std::vector<std::uint32_t>& from, std::size_t count,
                 std::vector<std::uint32_t>& into) {
  count = std::min(count, from.size());
  for (std::size_t k = 0; k < count; ++k) {
    into.push_back(from[(2 * k + 1) * from.size() / (2 * count)]);
  }
}

}  // namespace

void choose_samples(SurfaceLevel& level, int count, const ScanSurfaceOptions& options) {
  const RangeGrid& grid = level.grid;
  const auto turns = static_cast<float>(std::cos(options.crease_angle_rad));
  std::vector<std::uint8_t> crease(grid.size(), 0);
  std::vector<float> closeness(grid.size(), 0.0F);
  const auto cols = static_cast<std::ptrdiff_t>(grid.cols);
  const std::array<std::ptrdiff_t, 4> around{1, -1, cols, -cols};  // inside: i is no boundary sample …
  const auto beside_of = [&](std::size_t i, std::ptrdiff_t step) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + step);
  };
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        if (level.usable[i] == 0) {
          return;
        }
        float sum = 0;
        float neighbours = 0;
        for (const std::ptrdiff_t step : around) {
          const std::size_t j = beside_of(i, step);
          if (grid.valid[j] == 0) {
            continue;  // … but a narrow gap may be beside it
          }
          ++neighbours;
          sum += 1.0F / std::max((grid.point(j) - grid.point(i)).norm(),
                                 1e-3F * static_cast<float>(grid.spacing_mm));
          if (!level.normals[j].isZero() && level.normals[j].dot(level.normals[i]) < turns) {
            crease[i] = 1;
          }
        }
        closeness[i] = sum / std::max(neighbours, 1.0F);
      },
      8192);
  std::vector<std::uint32_t> edges;
  std::vector<std::uint8_t> beside(grid.size(), 0);
  std::vector<std::uint32_t> all;
  double mean = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (level.usable[i] == 0) {
      continue;
    }
    all.push_back(static_cast<std::uint32_t>(i));
    mean += static_cast<double>(closeness[i]);
    bool near_edge = crease[i] != 0;
    for (const std::ptrdiff_t step : around) {
      near_edge = near_edge || crease[beside_of(i, step)] != 0;
    }
    beside[i] = near_edge ? 1 : 0;
    if (near_edge) {
      edges.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (all.empty()) {
    return;
  }
  mean /= static_cast<double>(all.size());
  std::vector<std::uint32_t> chosen;
  const auto on_edges = std::min(static_cast<std::size_t>(options.most_crease_share * count), edges.size());
  take_spread(edges, on_edges, chosen);
  take_spread(all, static_cast<std::size_t>(count) - on_edges, chosen);
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  level.samples.reserve(chosen.size());
  for (const std::uint32_t i : chosen) {
    const auto row = i / cols;
    const auto col = i % cols;
    level.samples.push_back({grid.point(i), level.normals[i], closeness[i] / static_cast<float>(mean),
                             beside[i] != 0, static_cast<float>(row) / static_cast<float>(grid.rows),
                             static_cast<float>(col) / static_cast<float>(grid.cols)});
  }
}

}  // namespace dubsar
