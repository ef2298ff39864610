// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Closed loop of planning with true poses: a simulated tablet is scanned, flagged, cleared and planned until
// the red map is conclusive. Prints one line per scan and the verdict against the truth.
//   conclusive [width height thickness [spacing [noise [seed [max_scans]]]]]     (mm)
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/grid_lookup.h"
#include "core/grid_noise.h"
#include "core/units.h"
#include "planning/cleared_map.h"
#include "planning/clearing.h"
#include "planning/red_map.h"
#include "planning/sparse_flags.h"
#include "sim/reachable.h"
#include "sim/sim_station.h"
#include "sim/tablet.h"

namespace {

using namespace dubsar;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double area_of(const RedMap& map, RegionState state, Excuse excuse) {
  double area = 0;
  for (const RedRegion& r : map.regions) {
    area += r.state == state && r.excuse == excuse ? r.area_mm2 : 0.0;
  }
  return area;
}

/// Marks the points of the truth that a non-flagged sample of this scan lies beside.
void mark_sampled(const sim::Reach& truth, const PlacedScan& scan, std::vector<std::uint8_t>& sampled) {
  std::vector<std::uint8_t> keep(scan.grid->size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) ? 1 : 0;
  }
  const GridLookup lookup(*scan.grid, keep);
  const RigidTransform scanner_from_model = scan.model_from_scanner.inverse();
  const double radius_mm = 1.5 * scan.grid->spacing_mm + 3 * estimate_noise_mm(*scan.grid);
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const Eigen::Vector3f p = (scanner_from_model * truth.points[i].cast<double>().eval()).cast<float>();
    sampled[i] |= lookup.nearest(p, static_cast<float>(radius_mm)) >= 0 ? 1 : 0;
  }
}

double share_sampled(const sim::Reach& truth, const std::vector<std::uint8_t>& sampled) {
  std::size_t reachable = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    reachable += truth.reachable[i];
    both += truth.reachable[i] != 0 && sampled[i] != 0 ? 1 : 0;
  }
  return reachable > 0 ? static_cast<double>(both) / static_cast<double>(reachable) : 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, double fallback) { return argc > k ? std::atof(argv[k]) : fallback; };
  JobContext job;
  sim::TabletOptions tablet_options;
  tablet_options.size_mm = {number(1, 30), number(2, 25), number(3, 12)};
  tablet_options.seed = static_cast<std::uint64_t>(number(6, 1));
  sim::SimStationOptions station_options;
  station_options.scanner.spacing_mm = number(4, 0.2);
  station_options.scanner.noise_mm = number(5, 0.02);
  station_options.seed = tablet_options.seed;
  const int max_scans = static_cast<int>(number(7, 40));
  tablet_options.spacing_mm = std::max(0.1, 0.5 * station_options.scanner.spacing_mm);

  auto tablet = sim::make_tablet(tablet_options, job);
  if (!tablet) {
    std::fprintf(stderr, "%s\n", tablet.error().line().c_str());
    return 2;
  }
  sim::SimStation station(std::move(*tablet), station_options);
  const auto truth =
      sim::reachable_surface(station.tablet(), station.query(), station_options.scanner, {}, job);
  if (!truth) {
    std::fprintf(stderr, "%s\n", truth.error().line().c_str());
    return 2;
  }
  std::printf("tablet %.0f x %.0f x %.0f mm, %.0f mm2, reachable %.4f\n", tablet_options.size_mm.x(),
              tablet_options.size_mm.y(), tablet_options.size_mm.z(), surface_area_mm2(station.tablet().mesh),
              truth->share);

  const Rig rig = station.rig();
  ClearedMap cleared;
  std::vector<std::unique_ptr<RangeGrid>> grids;
  std::vector<std::uint8_t> sampled(truth->points.size(), 0);
  Placement placement;
  double predicted = 0;
  double red_before = 0;
  for (int k = 0; k < max_scans; ++k) {
    auto grid = station.scan_grid(job);
    if (!grid) {
      std::fprintf(stderr, "%s\n", grid.error().line().c_str());
      return 3;
    }
    grids.push_back(std::make_unique<RangeGrid>(std::move(*grid)));
    const SampleFlags flags = flag_sparse(*grids.back());
    auto start = std::chrono::steady_clock::now();
    cleared.add({k, grids.back().get(), &flags, station.true_tablet_from_scanner(), 0.01});
    const double clear_s = seconds_since(start);
    start = std::chrono::steady_clock::now();
    RedMapOptions options;
    options.stage = StageState{k, placement};
    const auto result = make_red_map(cleared.scans(), nullptr, &rig, options, job);
    const double plan_s = seconds_since(start);
    mark_sampled(*truth, cleared.scans().back(), sampled);
    const RedMap& map = result->map;
    const double red = area_of(map, RegionState::kRed, Excuse::kNone);
    std::printf(
        "%2d %7zu samples, clear %.3f s, plan %.3f s | red %8.2f mm2 in %4zu targets, predicted %7.2f actual "
        "%7.2f "
        "| unreachable %6.2f unneeded %5.2f mm2 | truth %.5f%s\n",
        k, grids.back()->valid_count(), clear_s, plan_s, red, result->targets.targets.size(), predicted,
        red_before - red, area_of(map, RegionState::kExcused, Excuse::kUnreachable),
        area_of(map, RegionState::kExcused, Excuse::kUnneeded), share_sampled(*truth, sampled),
        map.conclusive ? " CONCLUSIVE" : "");
    red_before = red;
    if (map.conclusive) {
      return 0;
    }
    if (map.next.empty()) {
      std::printf("no next view\n");
      for (const RedRegion& r : map.regions) {
        if (r.state == RegionState::kRed) {
          std::printf("  red %s %.3f mm2 at %.2f %.2f %.2f\n", to_string(r.face), r.area_mm2, r.center_mm.x(),
                      r.center_mm.y(), r.center_mm.z());
        }
      }
      return 1;
    }
    std::printf("   -> %s\n", map.next.front().say.c_str());
    predicted = map.next.front().predicted_cleared_mm2;
    placement = *map.next.front().placement;
    if (const Status moved = station.move(placement); !moved) {
      std::fprintf(stderr, "%s\n", moved.error().line().c_str());
      return 3;
    }
  }
  return 1;
}
