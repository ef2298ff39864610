// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/wedge_measure.h"

namespace dubsar {

struct JudgeOptions {
  double least_confidence = 0.5;
  /// Bounds that no writing exceeds; narrower ones follow from the tablet's own wedges.
  double min_depth_mm = 0.06;
  double max_depth_mm = 6.0;
  double min_edge_mm = 0.2;
  double max_edge_mm = 30.0;
  /// See roundness_of(); between those of wedges and those of bowls and cones, which docs/scholars/
  /// measurements.md has.
  double most_round = 0.45;
  /// Depth of the depth point, in depths of the lowest clay: dirt fills a wedge, but a shaft was never one.
  double most_floors = 3.0;
  int least_vertices = 15;  ///< on its three faces; fewer cannot be told from noise
};

/// Tells wedges from hollows that only look like ones (seed 000, 3.4): size bounds, how much of the model is
/// there, similarity to the tablet's other wedges and distance to them. Sets `confidence`, `evidence` and,
/// where it is too low, `rejected`. With fewer than ten good candidates the others' likeness counts for
/// nothing. Deterministic.
void judge_wedges(const JudgeOptions& options, std::vector<WedgeCandidate>* candidates);

/// The same of the last one alone, beside all of them; the others are not judged. There is one at least.
void judge_last_wedge(const JudgeOptions& options, std::vector<WedgeCandidate>* candidates);

}  // namespace dubsar
