// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/link_stitch.h"

#include <algorithm>

#include "bench/support/link_merge.h"

namespace dubsar::bench {

Mesh stitch_links(std::span<const PlacedScan> scans, const LinkStitchOptions& options) {
  LinkMesh model;
  double spacing_mm = 0;
  for (const PlacedScan& scan : scans) {
    LinkMesh next = link_mesh(scan, options.smoothing);
    spacing_mm = std::max(spacing_mm, scan.grid->spacing_mm);
    if (model.positions.empty()) {
      model = std::move(next);
      continue;
    }
    LinkMergeOptions merge;
    merge.reach = {static_cast<float>(options.reach_factor * spacing_mm),
                   static_cast<float>(options.across_factor * spacing_mm)};
    merge.one_to_one = options.one_to_one;
    model = merge_links(model, next, merge).mesh;
  }
  Mesh out;
  out.positions = std::move(model.positions);
  out.normals = std::move(model.normals);
  out.faces = std::move(model.faces);
  return out;
}

}  // namespace dubsar::bench
