// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/rim_targets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "planning/clusters.h"
#include "planning/point_cells.h"

namespace dubsar {

void settle_closed(std::span<const PlacedScan> scans, const SurfaceCover& cover, double noise_mm,
                   std::size_t most_stray_samples, RedTargets& red) {
  std::vector<std::size_t> samples(red.targets.size(), 0);
  for (const RedSampleRef& ref : red.samples) {
    ++samples[ref.target];
  }
  std::vector<SurfaceCover::Place> place(red.targets.size(), SurfaceCover::Place::kBare);
  parallel_for_each_index(
      red.targets.size(),
      [&](std::size_t i) {
        const RedTarget& t = red.targets[i];
        place[i] = cover.at(t.sample_mm, cover.cell_mm_at(t.sample_mm) + 3.0 * noise_mm);
        if (cover.at(t.position_mm, cover.reach_mm_at(t.position_mm)) == SurfaceCover::Place::kRim ||
            cover.at(t.sample_mm, cover.reach_mm_at(t.sample_mm)) == SurfaceCover::Place::kRim) {
          place[i] = SurfaceCover::Place::kRim;
        }
      },
      64);
  for (const auto& group : cluster_targets(red, scans, red.cell_mm, 2.0, false)) {
    bool rim = false;
    std::size_t count = 0;
    for (const std::uint32_t i : group) {
      rim = rim || place[i] == SurfaceCover::Place::kRim;
      count += place[i] == SurfaceCover::Place::kBare ? samples[i] : 0;
    }
    for (const std::uint32_t i : group) {
      RedTarget& t = red.targets[i];
      if (t.state != RegionState::kRed || place[i] == SurfaceCover::Place::kRim) {
        continue;
      }
      const bool closed = place[i] == SurfaceCover::Place::kClosed;
      if (closed) {
        t.excuse_as(Excuse::kUnneeded,
                    "nothing is missing: other scans sample the surface well on all sides of it");
        t.area_mm2 = 0;
      } else if (!rim && count <= most_stray_samples) {
        t.excuse_as_stray();
      }
    }
  }
}

void add_rim_targets(const SurfaceCover& cover, double widest_hole_mm, std::span<const std::uint8_t> apart,
                     RedTargets& red) {
  PointCells marked(2.0 * cover.reach_mm());
  for (std::uint32_t i = 0; i < red.targets.size(); ++i) {
    if (red.targets[i].state == RegionState::kRed && !red.targets[i].unseen) {
      marked.add(red.targets[i].position_mm, i);
      marked.add(red.targets[i].sample_mm, i);
    }
  }
  const std::vector<Rim>& rims = cover.rims();
  for (std::size_t h = 0; h < cover.holes().size(); ++h) {
    if (h < apart.size() && apart[h] != 0) {
      continue;
    }
    const Hole& hole = cover.holes()[h];
    for (const std::uint32_t i : hole.rim) {
      const double reach_mm = rims[i].reach_mm;
      bool known = false;
      marked.for_each_within(rims[i].position_mm, [&](std::uint32_t t) {
        const auto is_near = [&](const Eigen::Vector3d& p) {
          return (p - rims[i].position_mm).squaredNorm() <= 4.0 * reach_mm * reach_mm;
        };
        known = known || is_near(red.targets[t].position_mm) || is_near(red.targets[t].sample_mm);
      });
      if (known) {
        continue;
      }
      const double strip_mm2 = 0.5 * reach_mm / SurfaceCover::kReachInCells * reach_mm;
      const double share_mm2 =
          hole.width_mm > widest_hole_mm
              ? strip_mm2
              : std::max(0.25 * strip_mm2, hole.area_mm2 / static_cast<double>(hole.rim.size()));
      RedTarget target;
      target.position_mm = rims[i].position_mm + 0.5 * reach_mm * rims[i].outward;
      target.sample_mm = rims[i].position_mm;
      // The surface goes on there, turning away.
      target.normal = (rims[i].normal + 0.7 * rims[i].outward).normalized();
      target.area_mm2 = share_mm2;
      target.cell_share = reach_mm / cover.reach_mm();
      target.unseen = true;
      target.rim = true;
      red.targets.push_back(std::move(target));
    }
  }
}

}  // namespace dubsar
