// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_judge.h"

#include <algorithm>

namespace dubsar {

void judge_wedges(const JudgeOptions& options, std::vector<WedgeCandidate>* candidates) {
  for (WedgeCandidate& c : *candidates) {
    if (!c.rejected.empty()) {
      continue;
    }
    const Wedge& w = c.wedge;
    if (w.depth_mm < options.min_depth_mm || w.depth_mm > options.max_depth_mm) {
      c.rejected = "its depth is out of bounds";
    }
    const auto [shortest, longest] = std::ranges::minmax(w.edge_lengths_mm);
    if (shortest < options.min_edge_mm || longest > options.max_edge_mm) {
      c.rejected = "an inner edge is too short or too long";
    }
    c.wedge.confidence = 0.9;
  }
}

}  // namespace dubsar
