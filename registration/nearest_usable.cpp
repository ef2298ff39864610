// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/nearest_usable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dubsar {

namespace {

/// How far beyond a boundary sample the usable ones begin, in raster cells.
constexpr float kRimCells = 2.0F;

/// Memory that is asked for before the first of it is read: enough to wait once for many.
constexpr std::size_t kAtOnce = 32;

/// How far to look from p, by what the camera saw straight at it; 0 where there is nothing to be found.
float search_radius(const SurfaceLevel& level, const DepthRaster::Cell* cell, const Eigen::Vector3f& p,
                    float reach_mm) {
  const auto cell_mm = static_cast<float>(level.raster.cell_mm());
  if (cell == nullptr || cell->sample < 0) {
    return std::min(reach_mm, cell_mm);
  }
  const auto straight = static_cast<std::size_t>(cell->sample);
  if (std::abs(level.raster.height(p) - level.raster.height(*cell)) > 2.0F * reach_mm) {
    return 0;
  }
  const float d = 1.0001F * (cell->point_mm - p).norm();
  return std::min(reach_mm, level.usable[straight] != 0 ? d : d + kRimCells * cell_mm);
}

}  // namespace

std::int64_t nearest_usable(const SurfaceLevel& level, const Eigen::Vector3f& p, float reach_mm) {
  return level.lookup->nearest(p, search_radius(level, level.raster.at(p), p, reach_mm));
}

void nearest_usable(const SurfaceLevel& level, std::span<const Eigen::Vector3f> points, float reach_mm,
                    std::span<GridLookup::Found> found) {
  std::array<const DepthRaster::Cell*, kAtOnce> cells{};
  std::array<float, kAtOnce> radii_mm{};
  for (std::size_t begin = 0; begin < points.size(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, points.size() - begin);
    const std::span<const Eigen::Vector3f> some = points.subspan(begin, count);
    for (std::size_t k = 0; k < count; ++k) {
      cells[k] = level.raster.at(some[k]);
      __builtin_prefetch(cells[k]);
      level.lookup->fetch_buckets(some[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (cells[k] != nullptr && cells[k]->sample >= 0) {
        __builtin_prefetch(&level.usable[static_cast<std::size_t>(cells[k]->sample)]);
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      radii_mm[k] = search_radius(level, cells[k], some[k], reach_mm);
      level.lookup->fetch_samples(some[k], radii_mm[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      found[begin + k] = level.lookup->find_nearest(some[k], radii_mm[k]);
      if (found[begin + k].sample >= 0) {  // what is asked of it next
        __builtin_prefetch(&level.normals[static_cast<std::size_t>(found[begin + k].sample)]);
      }
    }
  }
}

bool lies_on(const SurfaceLevel& level, const GridLookup::Found& found, const Eigen::Vector3f& p) {
  const RangeGrid& grid = level.grid;
  const auto i = static_cast<std::size_t>(found.sample);
  const int row = grid.row_of(i);
  const int col = grid.col_of(i);
  const float d2 = (p - found.point_mm).squaredNorm();
  for (const auto& [r, c] : {std::pair{row - 1, col}, {row + 1, col}, {row, col - 1}, {row, col + 1}}) {
    if (grid.is_valid(r, c)) {
      const std::size_t j = grid.index(r, c);
      if (level.usable[j] == 0 && (p - grid.point(j)).squaredNorm() < d2) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace dubsar
