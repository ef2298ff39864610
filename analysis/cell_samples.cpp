// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/cell_samples.h"

#include <cmath>

#include "analysis/buckets.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;

struct Sum {
  Vector3f place{0, 0, 0};  ///< from the cell's corner, in cells, times weight and area
  Vector3f normal{0, 0, 0};
  float weighted = 0;
  float area = 0;
};

}  // namespace

std::vector<CellSample> gather_cell_samples(const std::vector<Vector3f>& positions_mm,
                                            const std::vector<Vector3f>& normals,
                                            const std::vector<float>& areas_mm2,
                                            const std::vector<float>& weights, const NodeGrid& grid) {
  if (grid.nx < 2 || grid.ny < 2 || grid.nz < 2) {
    return {};
  }
  const auto slabs = static_cast<std::size_t>(grid.nz - 1);
  const Vector3f top(static_cast<float>(grid.nx - 1), static_cast<float>(grid.ny - 1),
                     static_cast<float>(grid.nz - 1));
  const Buckets by_slab = make_buckets(positions_mm.size(), slabs, [&](std::size_t i) {
    const Vector3f at = grid.place(positions_mm[i]);
    const bool in =
        areas_mm2[i] > 0 && weights[i] > 0 && (at.array() >= 0).all() && (at.array() < top.array()).all();
    return in ? static_cast<std::size_t>(at.z()) : slabs;
  });
  std::vector<std::vector<CellSample>> parts(slabs);
  parallel_for_each_index(
      slabs,
      [&](std::size_t z) {
        std::vector<Sum> sums(grid.plane());
        for (std::uint32_t k = by_slab.start[z]; k < by_slab.start[z + 1]; ++k) {
          const std::uint32_t v = by_slab.item[k];
          const Vector3f at = grid.place(positions_mm[v]);
          const Vector3f corner = at.array().floor();
          Sum& sum =
              sums[static_cast<std::size_t>(corner.y()) * grid.row() + static_cast<std::size_t>(corner.x())];
          const float mass = weights[v] * areas_mm2[v];
          sum.place += mass * (at - corner);
          sum.normal += mass * normals[v];
          sum.weighted += mass;
          sum.area += areas_mm2[v];
        }
        for (int y = 0; y + 1 < grid.ny; ++y) {
          for (int x = 0; x + 1 < grid.nx; ++x) {
            const Sum& sum = sums[static_cast<std::size_t>(y) * grid.row() + static_cast<std::size_t>(x)];
            if (sum.weighted > 0) {
              CellSample sample;
              sample.x = x;
              sample.y = y;
              sample.z = static_cast<int>(z);
              sample.position_mm = grid.node_mm(x, y, sample.z) + grid.cell_mm / sum.weighted * sum.place;
              sample.area_normal_mm2 = sum.normal;
              sample.weighted_area_mm2 = sum.weighted;
              sample.area_mm2 = sum.area;
              parts[z].push_back(sample);
            }
          }
        }
      },
      1);
  std::vector<CellSample> samples;
  for (const auto& part : parts) {
    samples.insert(samples.end(), part.begin(), part.end());
  }
  return samples;
}

}  // namespace dubsar
