// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/nearest_usable.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

/// How far beyond a boundary sample the usable ones begin, in raster cells.
constexpr float kRimCells = 2.0F;

}  // namespace

std::int64_t nearest_usable(const SurfaceLevel& level, const Eigen::Vector3f& p, float reach_mm) {
  const DepthRaster::Cell* cell = level.raster.at(p);
  const auto cell_mm = static_cast<float>(level.raster.cell_mm());
  float radius_mm = std::min(reach_mm, cell_mm);
  if (cell != nullptr && cell->sample >= 0) {
    const auto straight = static_cast<std::size_t>(cell->sample);
    if (std::abs(level.raster.height(p) - cell->height_mm) > 2.0F * reach_mm) {
      return -1;
    }
    const float d = 1.0001F * (level.grid.point(straight) - p).norm();
    radius_mm = std::min(reach_mm, level.usable[straight] != 0 ? d : d + kRimCells * cell_mm);
  }
  return level.lookup->nearest(p, radius_mm);
}

}  // namespace dubsar
