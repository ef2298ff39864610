// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/distance_band.h"

#include <algorithm>
#include <cmath>

#include "core/mesh_query.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

/// Spreads along one axis: out[i] = 1 when anything within `reach` of i is set.
void dilate_axis(const NodeGrid& grid, int axis, int reach, std::vector<std::uint8_t>& marks) {
  const int length = axis == 0 ? grid.nx : axis == 1 ? grid.ny : grid.nz;
  const std::size_t step = axis == 0 ? 1 : axis == 1 ? grid.row() : grid.plane();
  const int outer = axis == 2 ? grid.ny : grid.nz;
  const int inner = axis == 0 ? grid.ny : grid.nx;
  parallel_for_each_index(
      static_cast<std::size_t>(outer),
      [&](std::size_t o) {
        std::vector<int> last(static_cast<std::size_t>(length));
        for (int k = 0; k < inner; ++k) {
          const std::size_t line = axis == 0   ? grid.index(0, k, static_cast<int>(o))
                                   : axis == 1 ? grid.index(k, 0, static_cast<int>(o))
                                               : grid.index(k, static_cast<int>(o), 0);
          // The nearest mark at or before each node, then at or behind it.
          int near = -reach - 1;
          for (int i = 0; i < length; ++i) {
            near = marks[line + step * static_cast<std::size_t>(i)] != 0 ? i : near;
            last[static_cast<std::size_t>(i)] = near;
          }
          near = length + reach;
          for (int i = length - 1; i >= 0; --i) {
            std::uint8_t& mark = marks[line + step * static_cast<std::size_t>(i)];
            near = mark != 0 ? i : near;
            mark = near - i <= reach || i - last[static_cast<std::size_t>(i)] <= reach ? 1 : 0;
          }
        }
      },
      1);
}

}  // namespace

std::vector<float> distances_near(const Mesh& surface, const NodeGrid& grid, const std::vector<float>& value,
                                  float below_mm, float above_mm) {
  std::vector<float> distance(grid.count());
  std::vector<std::uint8_t> near(grid.count(), 0);
  for (const Eigen::Vector3f& p : surface.positions) {
    const Eigen::Vector3f at = grid.place(p);
    near[grid.index(static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z()))] = 1;
  }
  const float reach_mm = std::max(below_mm, above_mm);
  for (int axis = 0; axis < 3; ++axis) {
    dilate_axis(grid, axis, static_cast<int>(std::ceil(reach_mm / grid.cell_mm)) + 1, near);
  }
  const MeshQuery query(surface);
  parallel_for_each_index(
      static_cast<std::size_t>(grid.ny) * static_cast<std::size_t>(grid.nz),
      [&](std::size_t row) {
        const int y = static_cast<int>(row % static_cast<std::size_t>(grid.ny));
        const int z = static_cast<int>(row / static_cast<std::size_t>(grid.ny));
        for (int x = 0; x < grid.nx; ++x) {
          const std::size_t i = grid.index(x, y, z);
          const bool inside = value[i] > 0;
          float d = inside ? below_mm : above_mm;
          if (near[i] != 0) {
            if (const auto hit = query.closest(grid.node_mm(x, y, z), d)) {
              d = std::min(d, static_cast<float>(hit->distance_mm));
            }
          }
          distance[i] = inside ? -d : d;
        }
      },
      4);
  return distance;
}

}  // namespace dubsar
