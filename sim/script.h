// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "sim/body.h"
#include "sim/impression.h"

namespace dubsar::sim {

struct ScriptOptions {
  std::uint64_t seed = 1;
  double line_height_mm = 0;  ///< 0: chosen from the size of the tablet
  double density = 1.0;       ///< share of the room for text that is written on, in [0, 1]
  bool edges = true;          ///< lines run on over the right edge and over the lower edge
  double dam_mm = 0.05;       ///< clay heaped up around a wedge
};

/// Writes text on the body in the order in which a scribe does: the obverse from top to bottom, over the
/// lower edge and up the reverse, each line from left to right; signs are drawn from a repertoire of the
/// seed's own, built of verticals, horizontals, obliques and Winkelhaken that cross and overlap.
[[nodiscard]] std::vector<Impression> write_text(const TabletBody& body, const ScriptOptions& options);

}  // namespace dubsar::sim
