// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace dubsar {

/// A regular grid of nodes; cells between them. Values lie [z][y][x].
struct NodeGrid {
  Eigen::Vector3f origin_mm{0, 0, 0};  ///< of node (0, 0, 0)
  float cell_mm = 1;
  int nx = 0, ny = 0, nz = 0;

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
  }
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::size_t row() const { return static_cast<std::size_t>(nx); }
  [[nodiscard]] std::size_t plane() const {
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
  }
  /// In cells from node (0, 0, 0).
  [[nodiscard]] Eigen::Vector3f place(const Eigen::Vector3f& p_mm) const {
    return (p_mm - origin_mm) / cell_mm;
  }
  [[nodiscard]] Eigen::Vector3f node_mm(int x, int y, int z) const {
    return origin_mm +
           cell_mm * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }
};

}  // namespace dubsar
