// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/node_grid.h"

namespace dubsar {

/// A multigrid V-cycle for (−Δ + diag(d)) x = b on the nodes of a grid, nothing flowing across its border
/// (Neumann): 7-point Laplacian, red-black Gauss-Seidel before and after (mirrored, so that the cycle is
/// symmetric and serves to precondition conjugate gradients), full weighting, trilinear interpolation.
/// Deterministic for any number of threads.
class Multigrid {
 public:
  /// diagonal >= 0, [nodes], per mm², not zero everywhere.
  Multigrid(const NodeGrid& grid, std::vector<float> diagonal);

  /// x ≈ (−Δ + d)⁻¹ b; x and b as long as the grid has nodes.
  void solve_roughly(const std::vector<float>& b, std::vector<float>& x);

  /// The length of one side that coarsens well: at least count, a few times a power of two, plus one.
  [[nodiscard]] static int rounded_up(int count);

 private:
  struct Level {
    NodeGrid grid;
    std::vector<float> diagonal, x, b;
  };
  void cycle(std::size_t level);

  std::vector<Level> levels_;
};

/// out = −Δ x with the border of Multigrid, over the grid's own spacing.
void apply_laplacian(const NodeGrid& grid, const std::vector<float>& x, std::vector<float>& out);

}  // namespace dubsar
