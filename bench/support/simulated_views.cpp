// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/simulated_views.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "core/random.h"
#include "core/units.h"
#include "planning/sparse_flags.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "sim/tablet.h"

namespace dubsar::bench {

namespace {

struct ViewOptions {
  int count = 1;
  Eigen::Vector3d size_mm{60, 50, 22};
  double spacing_mm = 0.05;
  double noise_mm = 0.02;
};

SimulatedViews make_views(const ViewOptions& options) {
  std::fprintf(stderr, "simulating %d scans at %g mm …\n", options.count, options.spacing_mm);
  JobContext job;
  sim::TabletOptions tablet_options;
  tablet_options.size_mm = options.size_mm;
  tablet_options.spacing_mm = 0.12;
  const auto tablet = sim::make_tablet(tablet_options, job);
  if (!tablet) {
    std::fprintf(stderr, "%s\n", tablet.error().line().c_str());
    std::exit(4);
  }
  const MeshQuery query(tablet->mesh);
  const sim::Scene scene{&*tablet, &query, {}, std::nullopt};
  const sim::TriangulationScanner scanner(
      sim::scanner_for(options.size_mm, options.spacing_mm, options.noise_mm));
  SimulatedViews views;
  const auto plan = sim::plan_views(options.count, 1);
  for (std::size_t k = 0; k < plan.size(); ++k) {
    auto grid = scanner.scan_grid(scene, plan[k].tablet_from_scanner, k, job);
    if (!grid) {
      std::fprintf(stderr, "%s\n", grid.error().line().c_str());
      std::exit(4);
    }
    // What a stage would say after a hand turn: off by some degrees and millimetres.
    Random hand(seed_for(7, k));
    const Eigen::Vector3d shift_mm = hand.normal3() * 1.5;
    const Eigen::Vector3d turn_rad = hand.normal3() * rad_from_deg(3.0);
    const RigidTransform off = RigidTransform::from_twist(turn_rad, shift_mm);
    grid->nominal = NominalPose{off * plan[k].tablet_from_scanner, static_cast<int>(k)};
    views.flags.push_back(flag_sparse(*grid));
    views.poses.push_back(plan[k].tablet_from_scanner);
    views.grids.push_back(std::make_shared<const RangeGrid>(std::move(*grid)));
  }
  return views;
}

}  // namespace

std::vector<PlacedScan> SimulatedViews::placed() const {
  std::vector<PlacedScan> scans;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    scans.push_back({static_cast<int>(k), grids[k].get(), &flags[k], poses[k], 0.0});
  }
  return scans;
}

std::size_t SimulatedViews::samples() const {
  std::size_t count = 0;
  for (const auto& grid : grids) {
    count += grid->valid_count();
  }
  return count;
}

const SimulatedViews& million_sample_views(int count) {
  static std::map<int, SimulatedViews> made;
  const auto found = made.find(count);
  return found != made.end() ? found->second
                             : made.emplace(count, make_views({.count = count})).first->second;
}

SimulatedViews make_views_of_millions(int count, double millions) {
  const double spacing_mm = 0.05 / std::sqrt(millions);
  return make_views(
      {.count = count, .size_mm = {70, 60, 24}, .spacing_mm = spacing_mm, .noise_mm = 0.4 * spacing_mm});
}

const SimulatedViews& views_of_millions(int millions) {
  static int made = 0;
  static SimulatedViews views;
  if (made != millions) {
    views = {};  // two sets of the larger ones need not fit
    views = make_views_of_millions(11, millions);
    made = millions;
  }
  return views;
}

}  // namespace dubsar::bench
