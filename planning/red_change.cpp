// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_change.h"

#include <algorithm>

#include "core/grid_lookup.h"
#include "core/grid_noise.h"
#include "core/parallel.h"
#include "planning/model_surface.h"

namespace dubsar {

std::vector<std::uint8_t> cleared_targets(const RedTargets& before, const PlacedScan& scan,
                                          const ClearingOptions& options) {
  std::vector<std::uint8_t> keep(scan.grid->size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) ? 1 : 0;
  }
  const GridLookup lookup(*scan.grid, keep);
  const double noise_mm = estimate_noise_mm(*scan.grid);
  const auto radius_mm = static_cast<float>(
      matching_radius_mm(*scan.grid, noise_mm, scan.sigma_mm, *scan.grid, noise_mm, scan.sigma_mm, options));
  const PlacedScan only[] = {scan};
  const double step_mm = std::max(ModelSurfaceOptions{}.step_mm, spacing_of(*scan.grid));
  const MeshQuery surface(thinned_surface(only, step_mm));
  const RigidTransform scanner_from_model = scan.model_from_scanner.inverse();
  std::vector<std::uint8_t> cleared(before.targets.size(), 0);
  parallel_for_each_index(before.targets.size(), [&](std::size_t i) {
    const RedTarget& t = before.targets[i];
    if (t.state != RegionState::kRed) {
      return;
    }
    const bool patch = t.unseen && !t.rim;
    const Eigen::Vector3d& at_mm = t.rim ? t.position_mm : t.sample_mm;
    const bool now = patch ? seen_from_outside(surface, {t.position_mm, t.normal, t.area_mm2}, step_mm)
                           : lookup.nearest((scanner_from_model * at_mm).cast<float>(), radius_mm) >= 0;
    cleared[i] = now ? 1 : 0;
  });
  return cleared;
}

double cleared_area_mm2(const RedTargets& before, const PlacedScan& scan, const ClearingOptions& options) {
  const std::vector<std::uint8_t> cleared = cleared_targets(before, scan, options);
  double area = 0;
  for (std::size_t i = 0; i < cleared.size(); ++i) {
    area += cleared[i] != 0 ? before.targets[i].area_mm2 : 0.0;
  }
  return area;
}

}  // namespace dubsar
