// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

namespace dubsar {

/// A wedge as the lines see it: where it lies along the writing and what it covers up the side, mm.
struct LineMember {
  double along = 0;
  double low = 0, high = 0;
  int line = 0;   ///< from 1, downwards
  int order = 0;  ///< from 1, along the line
};

/// Sorts the members of one side into lines. The lines may lean by some degrees: that lean is taken at which
/// the gaps between them are emptiest. Deterministic.
void find_lines(std::vector<LineMember>* members);

}  // namespace dubsar
