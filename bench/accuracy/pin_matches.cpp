// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/accuracy/pin_matches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "core/units.h"
#include "registration/absolute_orientation.h"
#include "registration/pin_detection.h"
#include "registration/pin_labels.h"
#include "registration/pin_matching.h"
#include "registration/pin_merge.h"
#include "sim/pins.h"

namespace dubsar::bench {

namespace {

/// Two placements of a tablet's pins, thinned out and soiled.
struct Trial {
  const char* name;
  bool labels;
  double mislabelled;  ///< share of each scan's labels
  int seen;            ///< of the true pins, in each scan
  int false_tips;      ///< in each scan
  std::size_t least_shared;
};

struct TrialSums {
  std::size_t pairs = 0, first = 0, among = 0, candidates = 0;
  std::size_t told = 0;  ///< right when told which pins correspond: the rest is the pins' own error
  double seconds = 0, most_seconds = 0;
};

RigidTransform random_pose(Random& random) {
  const Eigen::Vector3d xyz = random.normal3();
  const Eigen::Quaterniond q(random.normal(), xyz.x(), xyz.y(), xyz.z());
  return {q.normalized().toRotationMatrix(),
          {random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-20, 20)}};
}

/// The pins of a placement as a scan from `tablet_from_scanner` shows them.
std::vector<SeenPin> seen_pins(const std::vector<sim::Pin>& pins, const Trial& trial,
                               const RigidTransform& tablet_from_scanner, Random& random) {
  constexpr double kTipSigmaMm = 0.02;
  std::vector<sim::Pin> left = pins;
  for (std::size_t k = left.size(); k > 1; --k) {
    std::swap(left[k - 1], left[random.below(k)]);
  }
  left.resize(std::min(left.size(), static_cast<std::size_t>(trial.seen)));
  std::vector<SeenPin> out;
  Eigen::AlignedBox3d box;
  for (const sim::Pin& pin : pins) {
    box.extend(pin.tip_mm);
  }
  const auto add = [&](int label, const Eigen::Vector3d& at) {
    const Eigen::Vector3d off = random.normal3();
    out.push_back({trial.labels ? label : -1,
                   tablet_from_scanner.inverse() * Eigen::Vector3d(at + kTipSigmaMm * off),
                   kTipSigmaMm * kTipSigmaMm * Eigen::Matrix3d::Identity()});
  };
  for (const sim::Pin& pin : left) {
    add(random.uniform() < trial.mislabelled ? static_cast<int>(1 + random.below(15)) : pin.label,
        pin.tip_mm);
  }
  for (int k = 0; k < trial.false_tips; ++k) {
    const double z = random.uniform();
    const double y = random.uniform();
    const double x = random.uniform();
    const Eigen::Vector3d at = box.min() + Eigen::Vector3d(x, y, z).cwiseProduct(box.sizes());
    add(-1, at);
  }
  return out;
}

bool right(const RigidTransform& found, const RigidTransform& truth, const Eigen::Vector3d& middle_mm) {
  const RigidTransform turn{found.rotation * truth.rotation.transpose(), {0, 0, 0}};
  return turn.angle_rad() <= rad_from_deg(5) && (found * middle_mm - truth * middle_mm).norm() <= 3.0;
}

TrialSums match_trial(const PinArguments& arguments, const Trial& trial) {
  TrialSums sums;
  for (std::uint64_t seed = 1; seed <= arguments.matching; ++seed) {
    JobContext job;
    const auto tablet = sim::make_tablet(bench::random_tablet(seed, arguments.kind, 0.8), job);
    if (!tablet) {
      continue;
    }
    const MeshQuery query(tablet->mesh);
    sim::PinOptions options;
    options.seed = seed;
    const sim::PinStand stand(*tablet, query, options);
    Random random(seed_for(seed, 7));
    for (int repeat = 0; repeat < 10; ++repeat) {
      const RigidTransform a = random_pose(random);
      const RigidTransform b = random_pose(random);
      const std::vector<sim::Pin> pins_a = stand.placed(1 + 2 * repeat);
      const std::vector<sim::Pin> pins_b = stand.placed(2 + 2 * repeat);
      Random marks_a(seed_for(seed, static_cast<std::uint64_t>(100 + repeat)));
      Random marks_b(seed_for(seed, static_cast<std::uint64_t>(200 + repeat)));
      const std::vector<SeenPin> source = seen_pins(pins_a, trial, a, marks_a);
      const std::vector<SeenPin> target = seen_pins(pins_b, trial, b, marks_b);
      std::size_t shared = 0;  // by place, for labels may be wrong or missing
      std::vector<Eigen::Vector3d> from;
      std::vector<Eigen::Vector3d> to;
      for (const SeenPin& s : source) {
        for (const SeenPin& t : target) {
          if ((a * s.position_mm - b * t.position_mm).norm() < 1.8) {
            ++shared;
            from.push_back(s.position_mm);
            to.push_back(t.position_mm);
            break;
          }
        }
      }
      if (shared < trial.least_shared) {
        continue;
      }
      const auto start = std::chrono::steady_clock::now();
      const std::vector<PinMatch> found = match_pins(source, target, {});
      const double took = seconds_since(start);
      const RigidTransform truth = b.inverse() * a;
      const Eigen::Vector3d middle = a.inverse() * Eigen::Vector3d(0, 0, 0);
      const auto is_right = [&](const PinMatch& m) { return right(m.target_from_source, truth, middle); };
      ++sums.pairs;
      const auto told = absolute_orientation(from, to);
      sums.told += told && right(*told, truth, middle) ? 1U : 0U;
      sums.first += !found.empty() && is_right(found.front()) ? 1U : 0U;
      sums.among += std::any_of(found.begin(), found.end(), is_right) ? 1U : 0U;
      sums.candidates += found.size();
      sums.seconds += took;
      sums.most_seconds = std::max(sums.most_seconds, took);
    }
  }
  return sums;
}

}  // namespace

void match_scans(const PinArguments& arguments, const std::vector<bench::PinnedScan>& scans, bool labels,
                 const std::string& name, ScanPairSums& sums) {
  std::vector<std::vector<SeenPin>> tips;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    tips.push_back(detect_pins(scans[k].grid, arguments.tip_mm, {}).tips);
    if (labels) {
      tips.back() = labelled_tips(
          tips.back(), sim::clicked_tips(sim::tips_in_scanner(scans[k].pins, {}), 1.0, k), arguments.tip_mm);
    }
  }
  const auto true_label = [&](std::size_t scan, const SeenPin& tip) {
    for (const sim::Pin& pin : scans[scan].pins) {
      if ((pin.tip_mm - tip.position_mm).norm() < 0.3) {
        return pin.label;
      }
    }
    return -1;
  };
  for (std::size_t b = 1; b < scans.size(); ++b) {
    std::vector<PlacedPins> placed;
    for (std::size_t a = 0; a < b; ++a) {
      placed.push_back({tips[a], scans[a].tablet_from_scanner});
      std::size_t shared = 0;
      for (const SeenPin& s : tips[b]) {
        shared += std::any_of(tips[a].begin(), tips[a].end(),
                              [&](const SeenPin& t) {
                                return true_label(b, s) >= 0 && true_label(b, s) == true_label(a, t);
                              })
                      ? 1U
                      : 0U;
      }
      const RigidTransform truth = scans[a].tablet_from_scanner.inverse() * scans[b].tablet_from_scanner;
      const Eigen::Vector3d middle = scans[b].tablet_from_scanner.inverse() * Eigen::Vector3d(0, 0, 0);
      const std::vector<PinMatch> found = match_pins(tips[b], tips[a], {});
      bool here = false;
      for (std::size_t k = 0; k < found.size(); ++k) {
        const bool good = right(found[k].target_from_source, truth, middle);
        here = here || good;
      }
      if (shared >= 4) {
        ++sums.pairs;
        sums.right += here ? 1U : 0U;
      }
    }
    const std::vector<PinMatch> starts = match_pins(tips[b], merged_pins(placed), {});
    const auto good = [&](const PinMatch& m) {
      return right(m.target_from_source, scans[b].tablet_from_scanner,
                   scans[b].tablet_from_scanner.inverse() * Eigen::Vector3d(0, 0, 0));
    };
    const bool any = std::any_of(starts.begin(), starts.end(), good);
    sums.starts += starts.size();
    sums.first += !starts.empty() && good(starts.front()) ? 1U : 0U;
    ++sums.scans;
    sums.with_any += any ? 1U : 0U;
    if (arguments.verbose && !any) {
      std::printf("  %s scan %zu: %zu tips, no right start%s\n", name.c_str(), b, tips[b].size(),
                  labels ? " with labels" : "");
    }
  }
}

void measure_matching(const PinArguments& arguments) {
  constexpr Trial kTrials[] = {
      {"labelled, 8 of 15 seen, 4 shared or more", true, 0, 8, 0, 4},
      {"labelled, 8 seen, 4 false", true, 0, 8, 4, 4},
      {"labelled, 10 seen, 20 % mislabelled", true, 0.2, 10, 0, 4},
      {"labelled, 8 seen, 4 false, 20 % mislabelled", true, 0.2, 8, 4, 4},
      {"unlabelled, 15 seen", false, 0, 15, 0, 5},
      {"unlabelled, 10 seen, 5 shared or more", false, 0, 10, 0, 5},
      {"unlabelled, 8 seen, 5 shared or more", false, 0, 8, 0, 5},
      {"unlabelled, 8 seen, 4 shared or more", false, 0, 8, 0, 4},
      {"unlabelled, 10 seen, 5 false", false, 0, 10, 5, 5},
      {"unlabelled, 8 seen, 4 false", false, 0, 8, 4, 5},
  };
  std::printf("matching: right to 5 degrees and 3 mm\n");
  for (const Trial& trial : kTrials) {
    const TrialSums sums = match_trial(arguments, trial);
    const double pairs = static_cast<double>(std::max<std::size_t>(1, sums.pairs));
    std::printf(
        "  %-46s %5zu pairs: first %.1f %%, among all %.1f %% of %.1f candidates (told which: %.1f %%); %.2f "
        "ms, most %.1f ms\n",
        trial.name, sums.pairs, 100 * share(sums.first, sums.pairs), 100 * share(sums.among, sums.pairs),
        static_cast<double>(sums.candidates) / pairs, 100 * share(sums.told, sums.pairs),
        1000 * sums.seconds / pairs, 1000 * sums.most_seconds);
    std::fflush(stdout);
  }
}

}  // namespace dubsar::bench
