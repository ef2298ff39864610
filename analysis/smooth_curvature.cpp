// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/smooth_curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "analysis/cell_samples.h"
#include "core/big_array.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 14U;
constexpr float kEdgesPerCell = 2.0F;
constexpr float kMostNodes = 48e6F;
/// Cells of a neighbouring sheet (the other side of a thin sherd, of a crack) look elsewhere.
constexpr float kSameSide = 0.2F;
constexpr std::int32_t kNone = -1;

NodeGrid grid_for(const VertexGeometry& geometry, float scale_mm) {
  const Eigen::AlignedBox3f& box = geometry.box;
  NodeGrid grid;
  if (box.isEmpty()) {
    return grid;
  }
  const Vector3f size = box.sizes().array() + 4 * scale_mm;
  grid.cell_mm = std::max({scale_mm, kEdgesPerCell * static_cast<float>(geometry.mean_edge_mm),
                           std::cbrt(size.prod() / kMostNodes)});
  grid.origin_mm = box.min().array() - 1.5F * grid.cell_mm;
  grid.nx = static_cast<int>(box.sizes().x() / grid.cell_mm) + 5;
  grid.ny = static_cast<int>(box.sizes().y() / grid.cell_mm) + 5;
  grid.nz = static_cast<int>(box.sizes().z() / grid.cell_mm) + 5;
  return grid;
}

}  // namespace

std::vector<float> smooth_mean_curvature(const Mesh& mesh, const VertexGeometry& geometry, float scale_mm) {
  std::vector<float> curvature(mesh.positions.size(), 0.0F);
  const NodeGrid grid = grid_for(geometry, scale_mm);
  if (grid.nx == 0) {
    return curvature;
  }
  // Strays outside the box would lie in the border cells, whose neighbours are not there.
  std::vector<float> even(mesh.positions.size());
  parallel_for_each_index(
      even.size(), [&](std::size_t i) { even[i] = geometry.box.contains(mesh.positions[i]) ? 1.0F : 0.0F; },
      kGrain);
  std::vector<CellSample> cells =
      gather_cell_samples(mesh.positions, geometry.normal, geometry.area_mm2, even, grid);
  BigArray<std::int32_t> cell_at(grid.count());
  parallel_chunks(grid.count(), 1U << 20U, [&](std::size_t begin, std::size_t end) {
    std::fill_n(&cell_at[begin], end - begin, kNone);
  });
  parallel_for_each_index(cells.size(), [&](std::size_t i) {
    cell_at[grid.index(cells[i].x, cells[i].y, cells[i].z)] = static_cast<std::int32_t>(i);
    cells[i].area_normal_mm2.normalize();
  });
  std::vector<float> of_cell(cells.size());
  parallel_for_each_index(cells.size(), [&](std::size_t i) {
    const CellSample& here = cells[i];
    const std::size_t node = grid.index(here.x, here.y, here.z);
    float sum = 0;
    float weight = 0;
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          // The grid is a cell wider than the mesh on all sides.
          const std::ptrdiff_t step = dx + dy * static_cast<std::ptrdiff_t>(grid.row()) +
                                      dz * static_cast<std::ptrdiff_t>(grid.plane());
          const std::int32_t j = cell_at[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + step)];
          if (j == kNone || step == 0) {
            continue;
          }
          const CellSample& there = cells[static_cast<std::size_t>(j)];
          const Vector3f apart = there.position_mm - here.position_mm;
          if (here.area_normal_mm2.dot(there.area_normal_mm2) < kSameSide) {
            continue;
          }
          // Times |apart|²: near pairs, of cells hardly filled, say little.
          sum += there.area_mm2 * (there.area_normal_mm2 - here.area_normal_mm2).dot(apart);
          weight += there.area_mm2 * apart.squaredNorm();
        }
      }
    }
    of_cell[i] = weight > 0 ? sum / weight : 0.0F;
  });
  parallel_for_each_index(
      curvature.size(),
      [&](std::size_t v) {
        if (geometry.area_mm2[v] > 0 && geometry.box.contains(mesh.positions[v])) {
          const Vector3f at = grid.place(mesh.positions[v]);
          const std::int32_t i = cell_at[grid.index(static_cast<int>(at.x()), static_cast<int>(at.y()),
                                                    static_cast<int>(at.z()))];
          curvature[v] = i == kNone ? 0.0F : of_cell[static_cast<std::size_t>(i)];
        }
      },
      kGrain);
  return curvature;
}

}  // namespace dubsar
