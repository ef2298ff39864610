// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// How often registration accepts a wrong pose: simulated tablets scanned from free views and registered with
// nothing known, many of them such that no pose can be told (blank, worn, symmetric, another tablet among the
// scans, faces that do not overlap). Prints one line per case and the sums; exits 1 when any accepted pose is
// wrong.
//   dubsar-false-accepts [first seed [seeds [kind]]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.h"
#include "core/units.h"
#include "registration/registrar.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "sim/tablet.h"

namespace {

using namespace dubsar;

constexpr double kMostTurnDeg = 1.0;
constexpr double kMostShiftMm = 0.5;

struct Tally {
  int accepted = 0;
  int unsure = 0;
  int failed = 0;
  int wrong = 0;
  void add(const Tally& o) {
    accepted += o.accepted;
    unsure += o.unsure;
    failed += o.failed;
    wrong += o.wrong;
  }
};

struct Case {
  const char* kind;
  std::uint64_t seed;
  sim::TabletOptions tablet;
  std::vector<std::size_t> views;          ///< of the plan
  std::vector<std::size_t> foreign_views;  ///< of another tablet, which must not be registered with these
};

struct TrueScan {
  std::shared_ptr<const RangeGrid> grid;
  RigidTransform tablet_from_scanner;
  bool foreign = false;
};

sim::TabletOptions random_tablet(std::uint64_t seed, std::string_view kind) {
  Random random(seed * 1000 + 17);
  sim::TabletOptions t;
  t.seed = seed;
  t.size_mm.x() = random.uniform(20, 50);
  t.size_mm.y() = t.size_mm.x() * random.uniform(0.6, 1.2);
  t.size_mm.z() = t.size_mm.x() * random.uniform(0.35, 0.6);
  t.spacing_mm = 0.2;
  if (kind == "blank" || kind == "symmetric") {
    t.text_density = 0;
    t.seal_um = 0;
  }
  if (kind == "symmetric") {
    t.size_mm.y() = t.size_mm.x();
    t.unevenness_mm = 0;
    t.grain_um = 4;
    t.damage = sim::DamageOptions::none();
  }
  if (kind == "worn") {
    t.damage = {0.2, 1.0, 1.0, 0.2};
    t.text_density = 0.5;
  }
  return t;
}

std::vector<Case> cases_of(std::uint64_t seed) {
  const std::vector<std::size_t> six{0, 1, 2, 3, 4, 5};
  return {
      {"text", seed, random_tablet(seed, "text"), six, {}},
      {"blank", seed, random_tablet(seed, "blank"), six, {}},
      {"worn", seed, random_tablet(seed, "worn"), six, {}},
      {"symmetric", seed, random_tablet(seed, "symmetric"), six, {}},
      {"foreign", seed, random_tablet(seed, "text"), {0, 2, 3}, {0, 2}},
      {"faces", seed, random_tablet(seed, "text"), {0, 1}, {}},
  };
}

bool scan_views(const sim::TabletOptions& options, const std::vector<std::size_t>& views, std::uint64_t seed,
                bool foreign, std::vector<TrueScan>& into) {
  JobContext job;
  const auto tablet = sim::make_tablet(options, job);
  if (!tablet) {
    std::fprintf(stderr, "%s\n", tablet.error().line().c_str());
    return false;
  }
  const MeshQuery query(tablet->mesh);
  const sim::Scene scene{&*tablet, &query, {}, std::nullopt};
  const sim::TriangulationScanner scanner(sim::scanner_for(options.size_mm, 0.25, 0.02));
  const auto plan = sim::plan_views(8, seed);
  for (const std::size_t v : views) {
    auto grid = scanner.scan_grid(scene, plan[v].tablet_from_scanner, seed * 100 + v, job);
    if (!grid) {
      std::fprintf(stderr, "%s\n", grid.error().line().c_str());
      return false;
    }
    into.push_back(
        {std::make_shared<const RangeGrid>(std::move(*grid)), plan[v].tablet_from_scanner, foreign});
  }
  return true;
}

/// Nothing when a scan could not be made.
std::optional<Tally> run(const Case& c) {
  std::vector<TrueScan> scans;
  sim::TabletOptions other = c.tablet;
  other.seed = c.seed + 5000;
  if (!scan_views(c.tablet, c.views, c.seed, false, scans) ||
      (!c.foreign_views.empty() && !scan_views(other, c.foreign_views, c.seed + 5000, true, scans))) {
    return std::nullopt;
  }
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    registrar.add(static_cast<int>(k), scans[k].grid, nullptr, job);
  }
  if (!registrar.finalize(job)) {
    return std::nullopt;
  }
  Tally tally;
  const ScanPose* first = nullptr;
  const std::vector<ScanPose> poses = registrar.poses();
  for (const ScanPose& pose : poses) {
    if (pose.status != PoseStatus::kRegistered) {
      (pose.status == PoseStatus::kUnsure ? tally.unsure : tally.failed) += 1;
      continue;
    }
    ++tally.accepted;
    if (first == nullptr) {
      first = &pose;
      continue;
    }
    const TrueScan& base = scans[static_cast<std::size_t>(first->id)];
    const TrueScan& scan = scans[static_cast<std::size_t>(pose.id)];
    const RigidTransform mine = first->model_from_scanner.inverse() * pose.model_from_scanner;
    const RigidTransform truth = base.tablet_from_scanner.inverse() * scan.tablet_from_scanner;
    // The centre of the tablet, in the scan's frame.
    const Eigen::Vector3d center_mm = scan.tablet_from_scanner.inverse() * Eigen::Vector3d(0, 0, 0);
    const RigidTransform turn{mine.rotation * truth.rotation.transpose(), {0, 0, 0}};
    const double turn_deg = deg_from_rad(turn.angle_rad());
    const double shift_mm = (mine * center_mm - truth * center_mm).norm();
    if (base.foreign != scan.foreign || turn_deg > kMostTurnDeg || shift_mm > kMostShiftMm) {
      ++tally.wrong;
      std::printf("WRONG %s %llu: scan %d on scan %d%s, %.2f degrees and %.2f mm off, overlap %.2f\n", c.kind,
                  static_cast<unsigned long long>(c.seed), pose.id, first->id,
                  base.foreign != scan.foreign ? " of another tablet" : "", turn_deg, shift_mm, pose.overlap);
    }
  }
  return tally;
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, std::uint64_t fallback) {
    return argc > k ? std::strtoull(argv[k], nullptr, 10) : fallback;
  };
  const std::uint64_t first_seed = number(1, 1);
  const std::uint64_t seeds = number(2, 4);
  const std::string_view only = argc > 3 ? argv[3] : "";
  Tally total;
  for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    for (const Case& c : cases_of(seed)) {
      if (!only.empty() && only != c.kind) {
        continue;
      }
      const std::optional<Tally> tally = run(c);
      if (!tally) {
        return 2;
      }
      std::printf("%-9s %4llu  %4.0f x %2.0f x %2.0f mm  accepted %d  unsure %d  failed %d  wrong %d\n",
                  c.kind, static_cast<unsigned long long>(seed), c.tablet.size_mm.x(), c.tablet.size_mm.y(),
                  c.tablet.size_mm.z(), tally->accepted, tally->unsure, tally->failed, tally->wrong);
      std::fflush(stdout);
      total.add(*tally);
    }
  }
  std::printf("accepted %d  unsure %d  failed %d  wrong %d\n", total.accepted, total.unsure, total.failed,
              total.wrong);
  return total.wrong == 0 ? 0 : 1;
}
