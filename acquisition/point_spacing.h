// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dubsar {

/// Median distance of a point to its nearest neighbour elsewhere, over at most 20 000 of the points spread
/// evenly through the list; 0 with fewer than two different points. Finite points only.
[[nodiscard]] double median_nearest_mm(const std::vector<Eigen::Vector3f>& points);

/// The spacing that a square lattice with as many points on the same ground (x, y) would have: what matters
/// where points fall at random and their nearest neighbours are nearer than that. The ground is counted in
/// cells of four times nearest_mm.
[[nodiscard]] double even_spacing_mm(const std::vector<Eigen::Vector3f>& points, double nearest_mm);

}  // namespace dubsar
