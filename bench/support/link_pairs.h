// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "bench/support/link_mesh.h"

namespace dubsar::bench {

/// Two vertices are too far from each other for a pair beyond `all_mm`, or beyond `across_mm` in the scanner
/// plane of the first.
struct LinkReach {
  float all_mm = 0;
  float across_mm = 0;
};

/// [V of `from`] the vertex of `to` closest to each, or -1 where none is within reach whose normal is within
/// 60° of its own. Time and memory linear in the vertices.
[[nodiscard]] std::vector<std::int64_t> closest_vertices(const LinkMesh& from, const LinkMesh& to,
                                                         const LinkReach& reach);

}  // namespace dubsar::bench
