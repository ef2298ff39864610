// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dubsar {

/// A coarse lattice over a grid of samples: one node for each block of kNodeSide x kNodeSide samples. What
/// changes slowly along the surface (which scans overlap here, which of them sees it best) is asked of nodes.
struct Lattice {
  static constexpr int kNodeSide = 4;

  int rows = 0;  ///< of the grid, samples
  int cols = 0;
  int node_rows = 0;
  int node_cols = 0;

  Lattice() = default;
  Lattice(int grid_rows, int grid_cols)
      : rows(std::max(grid_rows, 0)),
        cols(std::max(grid_cols, 0)),
        node_rows((rows + kNodeSide - 1) / kNodeSide),
        node_cols((cols + kNodeSide - 1) / kNodeSide) {}

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(node_rows) * static_cast<std::size_t>(node_cols);
  }
  [[nodiscard]] std::size_t node(int node_row, int node_col) const {
    return static_cast<std::size_t>(node_row) * static_cast<std::size_t>(node_cols) +
           static_cast<std::size_t>(node_col);
  }
  [[nodiscard]] std::size_t node_of(std::size_t sample) const {
    return node(sample_row(sample) / kNodeSide, sample_col(sample) / kNodeSide);
  }
  // Of 32 bits, since many processors take twice as long and more for a division of 64.
  [[nodiscard]] int row_of(std::size_t node) const {
    return static_cast<int>(static_cast<std::uint32_t>(node) / static_cast<std::uint32_t>(node_cols));
  }
  [[nodiscard]] int col_of(std::size_t node) const {
    return static_cast<int>(static_cast<std::uint32_t>(node) % static_cast<std::uint32_t>(node_cols));
  }

  [[nodiscard]] int sample_row(std::size_t sample) const {
    return static_cast<int>(static_cast<std::uint32_t>(sample) / static_cast<std::uint32_t>(cols));
  }
  [[nodiscard]] int sample_col(std::size_t sample) const {
    return static_cast<int>(static_cast<std::uint32_t>(sample) % static_cast<std::uint32_t>(cols));
  }

  /// Calls visit(sample) for the samples of a node's block, row by row.
  template <class Visit>
  void for_each_sample(std::size_t node, const Visit& visit) const {
    for_each_place(node, [&](int, int, std::size_t sample) { visit(sample); });
  }
  /// visit(row, col, sample) for the same.
  template <class Visit>
  void for_each_place(std::size_t node, const Visit& visit) const {
    const int row = row_of(node) * kNodeSide;
    const int col = col_of(node) * kNodeSide;
    for (int r = row; r < std::min(row + kNodeSide, rows); ++r) {
      for (int c = col; c < std::min(col + kNodeSide, cols); ++c) {
        visit(r, c,
              static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c));
      }
    }
  }
  /// True when holds(node) for one of the nodes within `radius` nodes (a square) of a node.
  template <class Holds>
  [[nodiscard]] bool any_within(std::size_t node_index, int radius, const Holds& holds) const {
    const int row = row_of(node_index);
    const int col = col_of(node_index);
    for (int r = std::max(row - radius, 0); r <= std::min(row + radius, node_rows - 1); ++r) {
      for (int c = std::max(col - radius, 0); c <= std::min(col + radius, node_cols - 1); ++c) {
        if (holds(node(r, c))) {
          return true;
        }
      }
    }
    return false;
  }
};

/// In place: each value becomes the mean over the (2·radius+1)² window around it, of those with mask != 0;
/// zero where the window holds none.
void box_mean(std::vector<float>& values, const std::vector<std::uint8_t>& mask, int rows, int cols,
              int radius);

}  // namespace dubsar
