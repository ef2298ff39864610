// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-pins: how well pins are found, masked and matched in scans of simulated tablets, against the truth.

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/support/pinned_scans.h"
#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "core/random.h"
#include "core/units.h"
#include "registration/absolute_orientation.h"
#include "registration/pin_detection.h"
#include "registration/pin_labels.h"
#include "registration/pin_matching.h"
#include "registration/pin_merge.h"
#include "sim/pins.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  std::string kind = "text";
  std::uint64_t first_seed = 1;
  std::uint64_t tablets = 4;
  int views = 12;
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  double tip_mm = 1.0;
  bool verbose = false;
  std::uint64_t matching = 0;
};

/// Tips by how much of their ball is seen, in parts of the ball's whole disc: side on, the free half is 0.5.
constexpr double kShareEdges[] = {0.0, 0.1, 0.25, 0.4};
constexpr std::size_t kShares = std::size(kShareEdges);

struct Sums {
  int scans = 0;
  std::size_t tips[kShares] = {};
  std::size_t found_tips[kShares] = {};
  std::size_t detected = 0, false_tips = 0;
  std::size_t pin = 0, pin_unmasked = 0, stray_pin = 0, stray_pin_unmasked = 0;
  std::size_t clay = 0, clay_masked = 0, stray_clay = 0, stray_clay_masked = 0;
  std::vector<double> error_mm;
  std::vector<double> normalised;  ///< squared error in parts of the tip's covariance, per degree of freedom
  double seconds = 0, samples = 0;
};

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v * v;
  }
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

void measure(const Arguments& arguments, const bench::PinnedScan& scan, const std::string& name, Sums& sums) {
  const auto start = std::chrono::steady_clock::now();
  const PinDetection found = detect_pins(scan.grid, arguments.tip_mm, {});
  sums.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  sums.samples += static_cast<double>(scan.grid.size());
  ++sums.scans;
  const double radius_mm = 0.5 * arguments.tip_mm;
  const double disc = kPi * radius_mm * radius_mm / (arguments.spacing_mm * arguments.spacing_mm);
  std::vector<bool> used(found.tips.size(), false);
  for (const sim::Pin& pin : scan.pins) {
    const int seen = bench::ball_samples(scan, pin);
    if (seen == 0) {
      continue;
    }
    std::size_t bin = 0;
    while (bin + 1 < kShares && seen >= kShareEdges[bin + 1] * disc) {
      ++bin;
    }
    ++sums.tips[bin];
    double nearest_mm = radius_mm;
    std::size_t best = found.tips.size();
    for (std::size_t k = 0; k < found.tips.size(); ++k) {
      const double off = (found.tips[k].position_mm - pin.tip_mm).norm();
      if (!used[k] && off < nearest_mm) {
        nearest_mm = off;
        best = k;
      }
    }
    if (best < found.tips.size()) {
      used[best] = true;
      ++sums.found_tips[bin];
      sums.error_mm.push_back(nearest_mm);
      const Eigen::Vector3d off = found.tips[best].position_mm - pin.tip_mm;
      sums.normalised.push_back(off.dot(found.tips[best].covariance_mm2.ldlt().solve(off)) / 3.0);
    }
    if (arguments.verbose && (best == found.tips.size() || nearest_mm > 0.15)) {
      std::printf("  %s pin %d %s (%.3f) at %.1f %.1f %.1f seen %.2f arm %.2f %.2f %.2f\n", name.c_str(),
                  pin.label, best == found.tips.size() ? "missed" : "off", nearest_mm, pin.tip_mm.x(),
                  pin.tip_mm.y(), pin.tip_mm.z(), seen / disc, pin.arm.x(), pin.arm.y(), pin.arm.z());
    }
  }
  sums.detected += found.tips.size();
  for (std::size_t k = 0; k < found.tips.size(); ++k) {
    if (!used[k]) {
      ++sums.false_tips;
      if (arguments.verbose) {
        const Eigen::Vector3d& p = found.tips[k].position_mm;
        std::printf("  %s false tip at %.2f %.2f %.2f\n", name.c_str(), p.x(), p.y(), p.z());
      }
    }
  }
  std::size_t unmasked = 0;
  std::size_t clay_masked = 0;
  for (std::size_t i = 0; i < scan.grid.size(); ++i) {
    const bool masked = found.mask[i] != 0;
    switch (scan.truth[i]) {
      case bench::SampleTruth::kPin:
        ++sums.pin;
        unmasked += masked ? 0 : 1;
        break;
      case bench::SampleTruth::kStrayPin:
        ++sums.stray_pin;
        sums.stray_pin_unmasked += masked ? 0 : 1;
        break;
      case bench::SampleTruth::kClay:
        ++sums.clay;
        clay_masked += masked ? 1 : 0;
        break;
      case bench::SampleTruth::kStrayClay:
        ++sums.stray_clay;
        sums.stray_clay_masked += masked ? 1 : 0;
        break;
      case bench::SampleTruth::kNothing:
        break;
    }
  }
  sums.pin_unmasked += unmasked;
  sums.clay_masked += clay_masked;
  if (arguments.verbose && (unmasked > 0 || clay_masked > 0)) {
    std::printf("  %s pin samples not masked %zu, clay samples masked %zu\n", name.c_str(), unmasked,
                clay_masked);
  }
}

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
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
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
    const Eigen::Vector3d off(random.normal(), random.normal(), random.normal());
    out.push_back({trial.labels ? label : -1,
                   tablet_from_scanner.inverse() * Eigen::Vector3d(at + kTipSigmaMm * off),
                   kTipSigmaMm * kTipSigmaMm * Eigen::Matrix3d::Identity()});
  };
  for (const sim::Pin& pin : left) {
    add(random.uniform() < trial.mislabelled ? static_cast<int>(1 + random.below(15)) : pin.label,
        pin.tip_mm);
  }
  for (int k = 0; k < trial.false_tips; ++k) {
    const Eigen::Vector3d at =
        box.min() +
        Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(box.sizes());
    add(-1, at);
  }
  return out;
}

bool right(const RigidTransform& found, const RigidTransform& truth, const Eigen::Vector3d& middle_mm) {
  const RigidTransform turn{found.rotation * truth.rotation.transpose(), {0, 0, 0}};
  return turn.angle_rad() <= rad_from_deg(5) && (found * middle_mm - truth * middle_mm).norm() <= 3.0;
}

struct ScanPairSums {
  std::size_t pairs = 0, right = 0;                ///< of two scans that share four true tips that both found
  std::size_t scans = 0, with_any = 0, first = 0;  ///< scans with a right start on the earlier ones, merged
  std::size_t starts = 0;
};

/// Matches the detected tips of all scans of one tablet, with labels as an operator clicks them or without.
void match_scans(const Arguments& arguments, const std::vector<bench::PinnedScan>& scans, bool labels,
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

TrialSums match_trial(const Arguments& arguments, const Trial& trial) {
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
      const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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

void measure_matching(const Arguments& arguments) {
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

void print(const Arguments& arguments, const Sums& sums) {
  std::printf("%s, spacing %.3f mm, noise %.3f mm, tips of %.1f mm: %d scans\n", arguments.kind.c_str(),
              arguments.spacing_mm, arguments.noise_mm, arguments.tip_mm, sums.scans);
  for (std::size_t k = kShares; k-- > 0;) {
    std::printf("  balls seen to %.2f%s of their disc: %zu, found %.1f %%\n", kShareEdges[k],
                k + 1 < kShares ? " and more" : " or more", sums.tips[k],
                100 * share(sums.found_tips[k], sums.tips[k]));
  }
  std::printf("  precision %.2f %% (%zu of %zu false)\n", 100 * (1 - share(sums.false_tips, sums.detected)),
              sums.false_tips, sums.detected);
  std::printf("  centre off: rms %.1f um, 95 %% %.1f um, most %.1f um\n", 1000 * rms(sums.error_mm),
              1000 * quantile(sums.error_mm, 0.95), 1000 * quantile(sums.error_mm, 1.0));
  std::printf(
      "  squared error in parts of the covariance: median %.2f, mean %.2f, 95 %% %.2f (0.79, 1 and 2.60)\n",
      quantile(sums.normalised, 0.5), mean(sums.normalised), quantile(sums.normalised, 0.95));
  std::printf("  pin samples %zu, not masked %.1e; strays of pins %zu, not masked %.1e\n", sums.pin,
              share(sums.pin_unmasked, sums.pin), sums.stray_pin,
              share(sums.stray_pin_unmasked, sums.stray_pin));
  std::printf("  clay samples %zu, masked %.1e; strays of clay %zu, masked %.1e\n", sums.clay,
              share(sums.clay_masked, sums.clay), sums.stray_clay,
              share(sums.stray_clay_masked, sums.stray_clay));
  std::printf("  %.1f ms per million cells\n", 1e9 * sums.seconds / std::max(1.0, sums.samples));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"pins in scans of simulated tablets against the truth"};
  Arguments arguments;
  app.add_option("--kind", arguments.kind, "text, blank, worn, tiny or symmetric");
  app.add_option("--first", arguments.first_seed, "first seed");
  app.add_option("--tablets", arguments.tablets, "how many");
  app.add_option("--views", arguments.views, "scans of each");
  app.add_option("--spacing", arguments.spacing_mm, "of the scans, mm");
  app.add_option("--noise", arguments.noise_mm, "mm");
  app.add_option("--tip", arguments.tip_mm, "diameter of the tips, mm");
  app.add_flag("-v,--verbose", arguments.verbose, "each miss");
  app.add_option("--matching", arguments.matching, "tablets whose pins are matched, without scans of them");
  CLI11_PARSE(app, argc, argv);
  Sums sums;
  ScanPairSums from_scans[2];
  for (std::uint64_t k = 0; k < arguments.tablets; ++k) {
    const std::uint64_t seed = arguments.first_seed + k;
    const auto scans = bench::pinned_scans(
        bench::random_tablet(seed, arguments.kind, std::max(0.1, arguments.spacing_mm)),
        {arguments.spacing_mm, arguments.noise_mm, arguments.tip_mm, arguments.views, seed});
    for (std::size_t s = 0; s < scans.size(); ++s) {
      measure(arguments, scans[s], "tablet " + std::to_string(seed) + " scan " + std::to_string(s), sums);
    }
    for (const bool labels : {false, true}) {
      match_scans(arguments, scans, labels, "tablet " + std::to_string(seed), from_scans[labels ? 1 : 0]);
    }
  }
  if (arguments.tablets > 0) {
    print(arguments, sums);
    for (const bool labels : {false, true}) {
      const ScanPairSums& m = from_scans[labels ? 1 : 0];
      std::printf(
          "  %s: pairs of scans that share 4 tips %zu, right pose among the candidates %.1f %%; scans %zu "
          "with a right "
          "start on the earlier ones %.1f %%, as the first %.1f %%; %.1f starts a scan\n",
          labels ? "labelled" : "unlabelled", m.pairs, 100 * share(m.right, m.pairs), m.scans,
          100 * share(m.with_any, m.scans), 100 * share(m.first, m.scans),
          static_cast<double>(m.starts) / static_cast<double>(std::max<std::size_t>(1, m.scans)));
    }
  }
  if (arguments.matching > 0) {
    measure_matching(arguments);
  }
  return 0;
}
