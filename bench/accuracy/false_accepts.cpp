// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// How often registration accepts a wrong pose: simulated tablets scanned from free views and registered with
// nothing known, many of them such that no pose can be told (blank, worn, tiny, symmetric, ruled, another
// tablet among the scans, faces that do not overlap). Every scan but a tablet's first is one judged
// registration. Prints one line per case and the sums; exits 1 when any accepted pose is wrong.
//   dubsar-false-accepts [first seed [seeds [kind [spacing_mm]]]] [--gripped-every N]
#include <cstdio>
#include <string>
#include <vector>

#include "bench/support/options.h"
#include "bench/support/registered_poses.h"
#include "bench/support/true_scans.h"

namespace {

using namespace dubsar;

struct Tally {
  int judged = 0;
  int accepted = 0;
  int unsure = 0;
  int failed = 0;
  int wrong = 0;
  void add(const Tally& o) {
    judged += o.judged;
    accepted += o.accepted;
    unsure += o.unsure;
    failed += o.failed;
    wrong += o.wrong;
  }
};

struct Case {
  const char* name;
  const char* kind;                        ///< of tablet
  std::vector<std::size_t> views;          ///< of the plan
  std::vector<std::size_t> foreign_views;  ///< of another tablet, which must not be registered with these
  double ruled_every_mm = 0;               ///< see TrueScanOptions
};

const std::vector<Case>& cases() {
  static const std::vector<std::size_t> six{0, 1, 2, 3, 4, 5};
  static const std::vector<Case> all{
      {"text", "text", six, {}},        {"blank", "blank", six, {}},
      {"worn", "worn", six, {}},        {"symmetric", "symmetric", six, {}},
      {"tiny", "tiny", six, {}},        {"foreign", "text", {0, 2, 3}, {0, 2}},
      {"faces", "text", {0, 1}, {}},    {"blank faces", "blank", {0, 1}, {}},
      {"ruled", "ruled", six, {}, 2.5},
  };
  return all;
}

Tally run(const Case& c, std::uint64_t seed, double spacing_mm, int gripped_every,
          const sim::TabletOptions& tablet) {
  const auto scanning = [&](const std::vector<std::size_t>& views, std::uint64_t scan_seed, int number) {
    return bench::TrueScanOptions{.spacing_mm = spacing_mm,
                                  .views = 8,
                                  .only = views,
                                  .seed = scan_seed,
                                  .tablet_number = number,
                                  .gripped_every = gripped_every,
                                  .ruled_every_mm = c.ruled_every_mm};
  };
  std::vector<bench::TrueScan> scans = bench::true_scans(tablet, scanning(c.views, seed, 0));
  if (!c.foreign_views.empty()) {
    sim::TabletOptions other = tablet;
    other.seed = seed + 5000;
    for (bench::TrueScan& scan : bench::true_scans(other, scanning(c.foreign_views, other.seed, 1))) {
      scans.push_back(std::move(scan));
    }
  }
  Tally tally;
  tally.judged = static_cast<int>(scans.size()) - 1;
  const std::vector<ScanPose> poses = bench::registered_poses(scans);
  const ScanPose* first = nullptr;
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
    const bench::PairError error = bench::pair_error(scans, *first, pose);
    if (error.wrong()) {
      ++tally.wrong;
      std::printf("WRONG %s %llu: scan %d on scan %d%s, %.2f degrees and %.2f mm off, overlap %.2f\n", c.name,
                  static_cast<unsigned long long>(seed), pose.id, first->id,
                  error.foreign ? " of another tablet" : "", error.turn_deg, error.shift_mm, pose.overlap);
    }
  }
  return tally;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 4;
  std::string only;
  double spacing_mm = 0.25;
  int gripped_every = 0;
  std::vector<std::string> names{""};
  for (const Case& c : cases()) {
    names.emplace_back(c.name);
  }
  CLI::App app("Scans that are made to mislead: how many are accepted, and wrongly", "dubsar-false-accepts");
  app.add_option("first_seed", first_seed);
  app.add_option("seeds", seeds);
  app.add_option("case", only, "this one alone")->check(CLI::IsMember(names));
  app.add_option("spacing", spacing_mm, "mm")->check(CLI::Range(0.05, 2.0));
  app.add_option("--gripped-every", gripped_every, "fingers hold the tablet in each so manieth scan")
      ->check(CLI::Range(0, 100));
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  Tally total;
  for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    for (const Case& c : cases()) {
      if (!only.empty() && only != c.name) {
        continue;
      }
      const sim::TabletOptions tablet = bench::random_tablet(seed, c.kind, 0.2);
      const Tally tally = run(c, seed, spacing_mm, gripped_every, tablet);
      std::printf("%-11s %4llu  %2.0f x %2.0f x %2.0f mm  accepted %d  unsure %d  failed %d  wrong %d\n",
                  c.name, static_cast<unsigned long long>(seed), tablet.size_mm.x(), tablet.size_mm.y(),
                  tablet.size_mm.z(), tally.accepted, tally.unsure, tally.failed, tally.wrong);
      std::fflush(stdout);
      total.add(tally);
    }
  }
  std::printf("judged %d: accepted %d  unsure %d  failed %d  wrong %d\n", total.judged, total.accepted,
              total.unsure, total.failed, total.wrong);
  return total.wrong == 0 ? 0 : 1;
}
