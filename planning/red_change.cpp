// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_change.h"

#include <algorithm>

#include "core/grid_lookup.h"
#include "core/grid_noise.h"
#include "core/parallel.h"
#include "planning/model_surface.h"

namespace dubsar {

double cleared_area_mm2(const RedTargets& before, const PlacedScan& scan, const ClearingOptions& options) {
  std::vector<std::uint8_t> keep(scan.grid->size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) ? 1 : 0;
  }
  const GridLookup lookup(*scan.grid, keep);
  const double noise_mm = estimate_noise_mm(*scan.grid);
  const auto radius_mm = static_cast<float>(matching_radius_mm(*scan.grid, noise_mm, scan.sigma_mm, *scan.grid,
                                                               noise_mm, scan.sigma_mm, options));
  const PlacedScan only[] = {scan};
  const double step_mm = std::max(ModelSurfaceOptions{}.step_mm, spacing_of(*scan.grid));
  const MeshQuery surface(thinned_surface(only, step_mm));
  const RigidTransform scanner_from_model = scan.model_from_scanner.inverse();
  return parallel_reduce_ordered(
      before.targets.size(), 256, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double area = 0;
        for (std::size_t i = begin; i < end; ++i) {
          const RedTarget& t = before.targets[i];
          if (t.state != RegionState::kRed) {
            continue;
          }
          const bool cleared =
              t.unseen && !t.rim ? seen_from_outside(surface, {t.position_mm, t.normal, t.area_mm2}, step_mm)
                       : lookup.nearest((scanner_from_model * (t.rim ? t.position_mm : t.sample_mm)).cast<float>(), radius_mm) >= 0;
          area += cleared ? t.area_mm2 : 0.0;
        }
        return area;
      },
      [](double& into, double part) { into += part; });
}

}  // namespace dubsar
