// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/excuse.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/number_text.h"
#include "core/parallel.h"
#include "core/units.h"
#include "planning/clearing.h"
#include "planning/clusters.h"
#include "planning/convex_hull.h"
#include "planning/view_prediction.h"

namespace dubsar {

void excuse_strays(std::span<const PlacedScan> scans, std::span<const double> noise_mm,
                   const ModelSurface& surface, const ExcuseOptions& options, RedTargets& red) {
  std::vector<ViewPredictor> views;
  double apart_mm = options.stray_mm;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    views.emplace_back(ScannerModel::that_took(*scans[s].grid, nullptr, noise_mm[s]),
                       scans[s].model_from_scanner, surface.query, options.stray_mm);
    apart_mm = std::max(apart_mm, 2.0 * spacing_of(*scans[s].grid));
  }
  // A scan that made the return itself is no witness against it.
  std::vector<std::vector<std::uint32_t>> makers(red.targets.size());
  for (const RedSampleRef& ref : red.samples) {
    std::vector<std::uint32_t>& m = makers[ref.target];
    if (m.empty() || m.back() != ref.scan) {
      m.push_back(ref.scan);
    }
  }
  parallel_for_each_index(
      red.targets.size(),
      [&](std::size_t i) {
        RedTarget& target = red.targets[i];
        if (target.unseen || target.state != RegionState::kRed ||
            surface.query.closest(target.sample_mm.cast<float>(), static_cast<float>(apart_mm))) {
          return;
        }
        int past = 0;
        double nearest_mm = 0;
        for (std::uint32_t s = 0; s < views.size(); ++s) {
          if (std::binary_search(makers[i].begin(), makers[i].end(), s)) {
            continue;
          }
          const double behind_mm = views[s].looks_past_mm(target.sample_mm);
          if (behind_mm > 0) {
            nearest_mm = past == 0 ? behind_mm : std::min(nearest_mm, behind_mm);
            ++past;
          }
        }
        if (past >= options.stray_views) {
          target.excuse_as(Excuse::kUnneeded, "stray return in the air: " + std::to_string(past) +
                                                  " scans look past it at the surface, " +
                                                  fixed_text(nearest_mm, 1) + " mm behind");
          target.area_mm2 = 0;  // no surface is missing there
        }
      },
      16);
}

}  // namespace dubsar
