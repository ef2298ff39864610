// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace dubsar {

/// Few places that very many others are held against: which of them lie within one length. Each stands in all
/// 27 cells of space about it, so that one look finds them. Places are finite.
class NearCells {
 public:
  explicit NearCells(double edge_mm) : edge_mm_(edge_mm) {}

  void add(const Eigen::Vector3d& p, std::size_t number) {
    for (int k = 0; k < 27; ++k) {
      cells_[key_of(p, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1})].push_back(number);
    }
  }
  /// The numbers of all within one edge of the place, and of some beyond, in the order of their adding.
  [[nodiscard]] std::span<const std::size_t> about(const Eigen::Vector3d& p) const {
    const auto found = cells_.find(key_of(p, {0, 0, 0}));
    return found == cells_.end() ? std::span<const std::size_t>() : found->second;
  }

 private:
  /// Beyond a million cells from the origin all are one: found too often, never missed.
  [[nodiscard]] std::uint64_t key_of(const Eigen::Vector3d& p, const Eigen::Vector3i& step) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::clamp(std::floor(p[axis] / edge_mm_), -1e6, 1e6) + step[axis];
      key = (key << 21U) | static_cast<std::uint64_t>(static_cast<std::int64_t>(at) + (1 << 20));
    }
    return key;
  }

  double edge_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

}  // namespace dubsar
