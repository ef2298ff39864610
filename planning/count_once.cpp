// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/count_once.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planning/clusters.h"
#include "planning/point_cells.h"
#include "planning/red_regions.h"

namespace dubsar {

namespace {

bool is_patch(const RedTarget& target) {
  return target.unseen && !target.rim;
}

}  // namespace

void count_once(std::span<const PlacedScan> scans, double border_mm, RedTargets& red) {
  double patch_mm = 0;
  for (const RedTarget& t : red.targets) {
    patch_mm = is_patch(t) ? std::max(patch_mm, std::sqrt(t.area_mm2)) : patch_mm;
  }
  if (!(patch_mm > 0)) {
    return;
  }
  for (const auto& group :
       cluster_targets(red, scans, 2.0 * red.cell_mm, kRegionGridReachMm, true, 1.8 * patch_mm)) {
    PointCells patches(border_mm + patch_mm);
    double patches_mm2 = 0;
    for (const std::uint32_t i : group) {
      if (is_patch(red.targets[i])) {
        patches.add(red.targets[i].position_mm, i);
        patches_mm2 += red.targets[i].area_mm2;
      }
    }
    double border_mm2 = 0;
    std::vector<std::uint32_t> counted;
    for (const std::uint32_t i : group) {
      bool beside = is_patch(red.targets[i]);
      if (!beside) {
        patches.for_each_within(red.targets[i].position_mm, [&](std::uint32_t) { beside = true; });
        border_mm2 += beside ? red.targets[i].area_mm2 : 0.0;
      }
      if (beside) {
        counted.push_back(i);
      }
    }
    if (!(patches_mm2 > 0) || !(border_mm2 > 0)) {
      continue;
    }
    const double share = std::max(patches_mm2, border_mm2) / (patches_mm2 + border_mm2);
    for (const std::uint32_t i : counted) {
      red.targets[i].area_mm2 *= share;
    }
  }
}

}  // namespace dubsar
