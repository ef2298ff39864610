// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>

#include "bench/support/link_mesh.h"
#include "bench/support/link_pairs.h"
#include "bench/support/weak_edges.h"

namespace dubsar::bench {

struct LinkMergeOptions {
  LinkReach reach;
  /// True: a vertex is paired only with one that it is the closest of too; others near the other mesh stay
  /// with their triangles, as those do that are too far. False: each is paired with its closest.
  bool one_to_one = false;
};

struct LinkMerge {
  LinkMesh mesh;
  std::size_t pairs = 0;       ///< of vertices closest to each other
  std::size_t conforming = 0;  ///< edges that both meshes have
  WeakEdgeCounts edges;
};

/// Stitches meshes M and M' as seed 001, 4 does, read like this. P is paired with the vertex P' of the other
/// mesh closest to it. The less reliable of the two is no vertex of the result: the other stands for it in
/// its links. Of two boundary points, or two others, the one with the higher R is the more reliable; a
/// boundary point never is beside one that is none. The more reliable one moves along its ray to the average
/// of itself and where the ray meets the other mesh, weighted by R. What is merged keeps the R of its more
/// reliable vertex for the links, and the sum for averages to come.
///
/// An edge that both meshes have stays. One that only one has stays where both ends are of that mesh, goes
/// where both are of the other, and is weak between the two (the seed's cases 1 and 2; they say the same from
/// both ends). Then comes the second pass (weak_edges). Triangles are read off the links that are left
/// (link_faces); what those leave open stays open.
[[nodiscard]] LinkMerge merge_links(const LinkMesh& m, const LinkMesh& m2, const LinkMergeOptions& options);

}  // namespace dubsar::bench
