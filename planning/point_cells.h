// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace dubsar {

/// Finds the few points that lie within one length of a place, by cells of space of that length.
class PointCells {
 public:
  explicit PointCells(double edge_mm) : edge_mm_(edge_mm) {}
  void add(const Eigen::Vector3d& p, std::uint32_t i) { cells_[cell_of(p)].emplace_back(p, i); }
  template <class Visit>
  void for_each_within(const Eigen::Vector3d& p, const Visit& visit) const {
    const Cell cell = cell_of(p);
    for (int n = 0; n < 27; ++n) {
      const auto it = cells_.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (it == cells_.end()) {
        continue;
      }
      for (const auto& [q, i] : it->second) {
        if ((q - p).squaredNorm() <= edge_mm_ * edge_mm_) {
          visit(i);
        }
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3d& p) const {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) {
      cell[k] = static_cast<std::int64_t>(std::floor(p[static_cast<int>(k)] / edge_mm_));
    }
    return cell;
  }

  double edge_mm_;
  std::map<Cell, std::vector<std::pair<Eigen::Vector3d, std::uint32_t>>> cells_;
};

}  // namespace dubsar
