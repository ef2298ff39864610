// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/red_map.h"

#include <algorithm>

#include "core/parallel.h"
#include "planning/apart.h"
#include "planning/clearing.h"
#include "planning/count_once.h"
#include "planning/red_regions.h"
#include "planning/rim_targets.h"
#include "planning/surface_cover.h"

namespace dubsar {

namespace {

RedScan counts_of(const PlacedScan& scan, const SampleFlags& flags) {
  RedScan counts;
  counts.id = scan.id;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const std::uint8_t f = flags[i];
    if (scan.grid->valid[i] == 0 || (f & kNotTablet) != 0) {
      continue;
    }
    ++counts.samples;
    counts.potentially_sparse += (f & kPotentiallySparse) != 0 ? 1 : 0;
    counts.sparse += is_red(f) ? 1 : 0;
    counts.cleared += (f & (kSparse | kCleared)) == (kSparse | kCleared) ? 1 : 0;
    counts.excused += (f & kExcused) != 0 ? 1 : 0;
  }
  return counts;
}

const PlacedScan& last_scan(std::span<const PlacedScan> scans, const RedMapOptions& options) {
  if (options.stage) {
    for (const PlacedScan& scan : scans) {
      if (scan.id == options.stage->scan_id) {
        return scan;
      }
    }
  }
  return *std::max_element(scans.begin(), scans.end(),
                           [](const PlacedScan& a, const PlacedScan& b) { return a.id < b.id; });
}

Result<NextViews> plan_views(std::span<const PlacedScan> scans, const ModelSurface& surface,
                             const RedTargets& red, const Rig* rig, double noise_mm,
                             const RedMapOptions& options, JobContext& job) {
  const PlacedScan& last = last_scan(scans, options);
  NextViewOptions next = options.next;
  next.enough_chance = options.excuse.least_chance;
  if (rig != nullptr) {
    const StageState state = options.stage.value_or(StageState{last.id, {}});
    return next_views(rig_candidates(*rig, state, last, surface, options.next.candidates),
                      ScannerModel::of(*rig, noise_mm), surface, red.targets, next, job);
  }
  return next_views(free_candidates(last, surface, options.next.candidates),
                    ScannerModel::of(*last.grid, noise_mm), surface, red.targets, next, job);
}

}  // namespace

Result<RedMapResult> make_red_map(std::span<const PlacedScan> scans, const Mesh* model, const Rig* rig,
                                  const RedMapOptions& options, JobContext& job) {
  RedMapResult out;
  for (const PlacedScan& scan : scans) {
    out.flags.push_back(*scan.flags);
  }
  if (scans.empty()) {
    return out;
  }
  job.progress("red map", 0.0);
  const ModelSurface surface = model_surface(scans, model, options.surface);
  out.targets = red_targets(scans, surface, options.targets);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "planning was stopped");
  }
  std::vector<double> noise_mm;
  for (const PlacedScan& scan : scans) {
    noise_mm.push_back(noise_of(scan));
  }
  std::vector<double> sorted(noise_mm);
  std::sort(sorted.begin(), sorted.end());
  const double median_noise_mm = sorted[sorted.size() / 2];
  const SurfaceCover cover(scans);
  settle_closed(scans, cover, median_noise_mm, options.excuse.most_stray_samples, out.targets);
  excuse_strays(scans, noise_mm, surface, options.excuse, out.targets);
  const std::vector<std::uint8_t> apart = excuse_apart(scans, cover, out.targets);
  add_rim_targets(cover, options.targets.longest_gap_mm, apart, out.targets);
  excuse_unneeded(scans, cover, median_noise_mm, options.excuse, out.targets);
  // Strays and interpolated gaps are no border of a hole.
  const bool is_closed = cover.size() > 0 && std::ranges::find(apart, 0) == apart.end();
  drop_unbordered_patches(scans, is_closed, out.targets);
  double surface_mm2 = 0;
  for (const auto* patches : {&surface.seen, &surface.unseen}) {
    for (const SurfacePatch& patch : *patches) {
      surface_mm2 += patch.area_mm2;
    }
  }
  note_tries(scans, rig, noise_mm, surface, out.targets.targets);
  excuse_specks(scans, cover, surface_mm2, options.excuse, out.targets);
  excuse_tried(scans, cover, surface_mm2, options.excuse, out.targets);
  job.progress("red map", 0.5);

  RedTargets counted = out.targets;
  count_once(scans, cover.reach_mm(), counted);
  Result<NextViews> views = plan_views(scans, surface, counted, rig, median_noise_mm, options, job);
  if (!views) {
    return std::unexpected(views.error());
  }
  if (rig != nullptr) {
    excuse_out_of_reach(scans, cover, views->best_chance, surface_mm2, options.excuse, out.targets);
  }
  excuse_tried_out(scans, cover, *views, surface_mm2, options.excuse, out.targets);
  excuse_last_specks(scans, cover, views->best_gain_mm2, surface_mm2, options.excuse, out.targets);
  // What is excused was judged by all that borders it, to be on the safe side; stated is what is missing.
  for (std::size_t i = 0; i < counted.targets.size(); ++i) {
    out.targets.targets[i].area_mm2 = counted.targets[i].area_mm2;
  }
  for (const RedSampleRef& ref : out.targets.samples) {
    if (out.targets.targets[ref.target].state == RegionState::kExcused) {
      out.flags[ref.scan][ref.sample] |= kExcused;
    }
  }
  out.map.scans.resize(scans.size());
  parallel_for_each_index(
      scans.size(), [&](std::size_t s) { out.map.scans[s] = counts_of(scans[s], out.flags[s]); }, 1);
  out.map.regions = red_regions(out.targets, scans, surface);
  const bool any_red =
      std::any_of(out.map.regions.begin(), out.map.regions.end(),
                  [](const RedRegion& r) { return r.state == RegionState::kRed; }) ||
      std::any_of(out.map.scans.begin(), out.map.scans.end(), [](const RedScan& s) { return s.sparse > 0; });
  const bool any_sample =
      std::any_of(out.map.scans.begin(), out.map.scans.end(), [](const RedScan& s) { return s.samples > 0; });
  out.map.conclusive = any_sample && !any_red;
  if (any_red) {
    out.map.next = std::move(views->ranked);
  }
  job.progress("red map", 1.0);
  return out;
}

}  // namespace dubsar
