// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planning/red_targets.h"

namespace dubsar {

/// Sets that grow together; the root is the lowest member, so that numbers do not depend on the order.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count);
  [[nodiscard]] std::uint32_t find(std::uint32_t i);
  void join(std::uint32_t a, std::uint32_t b);
  /// The sets, by their lowest member, each in ascending order.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> groups();

 private:
  std::vector<std::uint32_t> parent_;
};

/// Groups targets that hang together and share state and excuse: neighbours in space within radius_mm (of
/// which each counts its cell_share, the greater one), and at least within at_least_mm; and neighbours in a
/// scan's grid whose targets lie within grid_reach_mm (the two rims of a gap). With `unseen_too` false only
/// targets with samples are grouped. Returns the members of each group, ascending, groups by their lowest
/// member.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> cluster_targets(const RedTargets& red,
                                                                      std::span<const PlacedScan> scans,
                                                                      double radius_mm, double grid_reach_mm,
                                                                      bool unseen_too,
                                                                      double at_least_mm = 0);

}  // namespace dubsar
