// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/seen_all_round.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

constexpr std::size_t kFacets = 200000;
/// Of µ: what is longer goes across a depth step.
constexpr float kStep = 5.0F;

}  // namespace

double share_turned_away(const RangeGrid& grid) {
  const auto most = static_cast<float>(kStep * grid.spacing_mm);
  const std::size_t stride = std::max<std::size_t>(1, grid.size() / kFacets);
  double towards = 0, away = 0;
  for (std::size_t i = 0; i < grid.size(); i += stride) {
    const int row = grid.row_of(i), col = grid.col_of(i);
    if (grid.valid[i] == 0 || !grid.is_valid(row, col + 1) || !grid.is_valid(row + 1, col)) {
      continue;
    }
    const Eigen::Vector3f p = grid.point(i);
    const Eigen::Vector3f along = grid.point(grid.index(row, col + 1)) - p;
    const Eigen::Vector3f down = grid.point(grid.index(row + 1, col)) - p;
    if (along.norm() > most || down.norm() > most) {
      continue;
    }
    // Samples err along the laser's rays, which therefore turn no facet.
    const Eigen::Vector3d at = p.cast<double>();
    const Eigen::Vector3d view =
        grid.view.laser_mm ? grid.view.to_laser(at, row) : grid.view.to_camera(at, row);
    const Eigen::Vector3f normal = along.cross(down);  // its length is an area
    (normal.dot(view.cast<float>()) > 0 ? towards : away) += static_cast<double>(normal.norm());
  }
  return towards + away > 0 ? std::min(towards, away) / (towards + away) : 0.0;
}

}  // namespace dubsar
