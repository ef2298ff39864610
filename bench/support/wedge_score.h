// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/wedge.h"

namespace dubsar::bench {

/// Found wedges against true ones, over any number of tablets.
struct WedgeScore {
  int right = 0;  ///< found wedges that are true ones, at least so far intact
  int false_ones = 0;
  int missed = 0;   ///< true wedges, at least so far intact, that were not found
  int ignored = 0;  ///< found ones that are remains of true ones
  int directional_right = 0;
  std::vector<double> depth_point_um, depth_um, edge_deg, opening_deg;
  std::vector<double> false_confidence, right_confidence;
  [[nodiscard]] double precision() const;
  [[nodiscard]] double recall() const;
  [[nodiscard]] double f1() const;
  void add(const WedgeScore& other);
};

struct ScoreOptions {
  double least_intact = 0.6;
  double reach_mm = 0.4;  ///< between the depth points of a pair
};

/// One to one, nearest depth points first. `pair`: [found] index of the true wedge, or -1.
[[nodiscard]] WedgeScore score_wedges(const std::vector<Wedge>& found, const std::vector<Wedge>& truth,
                                      const ScoreOptions& options, std::vector<int>* pair = nullptr);

[[nodiscard]] double median(std::vector<double> values);

}  // namespace dubsar::bench
