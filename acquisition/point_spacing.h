// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dubsar {

/// How points lie to their nearest neighbours elsewhere.
struct NeighbourStatistics {
  double median_mm = 0;  ///< 0 with fewer than two different points
  /// Direction of the nearest neighbour in the plane of x and y, up to quarter turns, in (-45°, 45°]; nothing
  /// when there is no direction that they share.
  std::optional<double> lattice_rad;
};

/// Over at most 20 000 of the points, spread evenly through the list. Finite points only.
[[nodiscard]] NeighbourStatistics nearest_neighbours(const std::vector<Eigen::Vector3f>& points);

/// The spacing that a square lattice with as many points on the same ground (x, y) would have: what matters
/// where points fall at random and their nearest neighbours are nearer than that. The ground is counted in
/// cells of four times nearest_mm.
[[nodiscard]] double even_spacing_mm(const std::vector<Eigen::Vector3f>& points, double nearest_mm);

}  // namespace dubsar
