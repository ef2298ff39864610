// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/true_surface.h"

#include <utility>

#include "core/mesh_query.h"
#include "core/parallel.h"

namespace dubsar::bench {

sim::SimTablet with_truth(Mesh scanned, const sim::SimTablet& truth) {
  constexpr float kNearMm = 1.0F;
  sim::SimTablet tablet = sim::tablet_from_mesh(std::move(scanned));
  tablet.kinds.assign(tablet.mesh.positions.size(), sim::SurfaceKind::kHole);
  tablet.wedges = truth.wedges;
  const MeshQuery query(truth.mesh);
  parallel_for_each_index(tablet.kinds.size(), [&](std::size_t i) {
    if (const auto near = query.closest(tablet.mesh.positions[i], kNearMm)) {
      const std::uint32_t v = truth.mesh.faces[near->face][0];
      tablet.kinds[i] = truth.kinds[v];
      tablet.wedge_of[i] = truth.wedge_of[v];
    }
  });
  return tablet;
}

}  // namespace dubsar::bench
