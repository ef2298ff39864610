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

#include "bench/accuracy/pin_matches.h"
#include "bench/support/options.h"
#include "bench/support/pinned_scans.h"
#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "core/stage_times.h"
#include "core/units.h"
#include "registration/pin_detection.h"
#include "sim/pins.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

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

void measure(const PinArguments& arguments, const bench::PinnedScan& scan, const std::string& name,
             Sums& sums) {
  const auto start = std::chrono::steady_clock::now();
  const PinDetection found = detect_pins(scan.grid, arguments.tip_mm, {});
  sums.seconds += seconds_since(start);
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

void print(const PinArguments& arguments, const Sums& sums) {
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
  PinArguments arguments;
  app.add_option("--kind", arguments.kind, "of the tablets")->check(bench::one_of(bench::kTabletKinds));
  app.add_option("--first", arguments.first_seed, "first seed");
  app.add_option("--tablets", arguments.tablets, "how many");
  app.add_option("--views", arguments.views, "scans of each");
  app.add_option("--spacing", arguments.spacing_mm, "of the scans, mm");
  app.add_option("--noise", arguments.noise_mm, "mm");
  app.add_option("--tip", arguments.tip_mm, "diameter of the tips, mm");
  app.add_flag("-v,--verbose", arguments.verbose, "each miss");
  app.add_option("--matching", arguments.matching, "tablets whose pins are matched, without scans of them");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
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
