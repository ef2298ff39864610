// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "analysis/node_grid.h"

namespace dubsar {

/// All vertices within one cell of a grid as one oriented sample.
struct CellSample {
  Eigen::Vector3f position_mm{0, 0, 0};      ///< mean by weight and area
  Eigen::Vector3f area_normal_mm2{0, 0, 0};  ///< Σ weight·area·normal
  float weighted_area_mm2 = 0;               ///< Σ weight·area
  float area_mm2 = 0;                        ///< Σ area
  int x = 0, y = 0, z = 0;                   ///< the cell
};

/// Gathers vertices by cell; in the order z, y, x of the cells. Vertices without area, weight or a place in
/// the grid are left out. All arrays [V].
[[nodiscard]] std::vector<CellSample> gather_cell_samples(const std::vector<Eigen::Vector3f>& positions_mm,
                                                          const std::vector<Eigen::Vector3f>& normals,
                                                          const std::vector<float>& areas_mm2,
                                                          const std::vector<float>& weights,
                                                          const NodeGrid& grid);

}  // namespace dubsar
