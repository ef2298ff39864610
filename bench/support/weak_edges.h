// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dubsar::bench {

/// What becomes of an edge of the merged links. A weak one is certain of nothing until the second pass.
struct LinkEdge {
  std::array<std::uint32_t, 2> ends{};
  bool is_weak = false;
  bool is_kept = true;
  Eigen::Vector3f plane{0, 0, 0};  ///< of a weak one: unit, across the scanner plane of the associated mesh
};

struct WeakEdgeCounts {
  std::size_t weak = 0;
  std::size_t crossed = 0;  ///< deleted for an edge that is not weak
  std::size_t outdone = 0;  ///< deleted for a weak one with a lower change of gradient
};

/// The second pass of seed 001, 4 over the edges of a mesh: each weak one is projected on its plane together
/// with the edges that start within two steps of its ends. One that crosses an edge which is not weak goes;
/// of two weak ones that cross, the one with the lower change of gradient stays, that is the one whose ends'
/// normals differ less (the shorter one where they tell nothing), as with the diagonals of a grid.
WeakEdgeCounts resolve_weak_edges(std::span<const Eigen::Vector3f> positions,
                                  std::span<const Eigen::Vector3f> normals, std::vector<LinkEdge>& edges);

}  // namespace dubsar::bench
