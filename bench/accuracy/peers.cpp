// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/peers.h"

#include "core/grid_geometry.h"

namespace dubsar::bench {

PeerPoints peer_points(const RangeGrid& grid) {
  const GridGeometry geometry = grid_geometry(grid);
  PeerPoints out;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && !geometry.normals[i].isZero()) {
      out.points_mm.emplace_back(grid.point(i).cast<double>());
      out.normals.emplace_back(geometry.normals[i].cast<double>());
    }
  }
  return out;
}

}  // namespace dubsar::bench
