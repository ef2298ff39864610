// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-registration: registration of simulated tablets against the truth, with nothing told of the poses.
// One line per tablet, then the sums: how many scans and tablets were registered, how far the surface is
// displaced after relaxation, whether the covariances are what they claim, how many scans came with a
// warning, of those that moved in the middle of the scan (--moved-every) and of the others, how long a scan
// took. Exits 1 when an accepted pose is wrong.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/accuracy/gauge.h"
#include "bench/support/moved_scan.h"
#include "bench/support/options.h"
#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "registration/registrar.h"
#include "registration/verify_pose.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  std::string kind = "text";
  std::string pins = "none";
  std::uint64_t first_seed = 1;
  std::uint64_t tablets = 4;
  int views = 12;
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  std::vector<double> size_mm;
  int gripped_every = 0;
  int moved_every = 0;
  double moved_mm = 0.15;
  bool verbose = false;
  bool at_truth = false;
};

struct Sums {
  int tablets = 0, whole_tablets = 0, scans = 0, registered = 0, unsure = 0, failed = 0, wrong = 0;
  int moved = 0, moved_registered = 0, moved_warned = 0, warned = 0;  ///< `warned`: of the others
  std::vector<double> displacement_mm;  ///< of points on the surface, scans of the model only
  std::vector<double> tablet_rms_mm;
  std::vector<double> nees;  ///< normalised squared error of each registered pose, per degree of freedom
  std::vector<double> add_s;
  std::vector<double> final_s;
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

/// All that speaks for and against a fit, as names and numbers in turn.
void print_evidence(const ModelFit& fit, const RegistrationOptions& options) {
  const PoseEvidence both = fit.both();
  std::printf(
      "overlap %.2f pair %.2f z %.1f rho %.2f slid %.1f agree %.3f through %.4f absent %.3f stability %.4f "
      "rms/s %.2f doubt %.2f",
      fit.overlap, fit.best_pair_overlap, fit.significance, fit.relief.correlation(), fit.slid_significance,
      both.agreement(), both.violation(), both.absence(), fit.icp.stability,
      fit.icp.rms_mm / fit.residual_sigma_mm, doubt(fit, options.search.verify));
}

std::vector<ScanFeatures> features_of(const std::vector<bench::TrueScan>& scans,
                                      const RegistrationOptions& options) {
  ScanSurfaceOptions surface_options = options.surface;
  surface_options.scale_mm = surface_scale_mm(*scans.front().grid);
  std::vector<ScanFeatures> features;
  for (const bench::TrueScan& scan : scans) {
    features.push_back(
        make_scan_features(make_scan_surface(*scan.grid, {}, surface_options), options.search.align));
  }
  return features;
}

/// What the true poses would be judged, against all other scans and against those of each side of the tablet:
/// tells a search that misses from a verdict that refuses.
void judge_truth(const std::vector<bench::TrueScan>& scans) {
  const RegistrationOptions options;
  const std::vector<ScanFeatures> features = features_of(scans, options);
  ModelFitOptions close = options.search.fit;
  close.starts_are_close = true;
  close.least_significance = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    for (const std::string side : {"all", "obverse", "reverse"}) {
      std::vector<ModelScan> model;
      for (std::size_t j = 0; j < scans.size(); ++j) {
        const bool obverse = scans[j].tablet_from_scanner.rotation.col(2).z() > 0;
        if (j != k && (side == "all" || (side == "obverse") == obverse)) {
          model.push_back({features[j].surface.get(), scans[j].tablet_from_scanner});
        }
      }
      std::vector<ModelFit> fits =
          fit_to_model(*features[k].surface, model, {&scans[k].tablet_from_scanner, 1}, close);
      const PoseVerdict verdict = verify_pose(fits, options.search.verify);
      std::printf("truth %zu %s %s ", k, side.c_str(), to_string(verdict.status));
      if (!fits.empty()) {
        print_evidence(fits.front(), options);
      }
      std::printf(" %s\n", verdict.reason.c_str());
    }
  }
}

/// Every pose that is found for a pair of scans, right or wrong: what verdicts are tuned on.
void list_fits(const std::vector<bench::TrueScan>& scans, std::uint64_t seed) {
  const RegistrationOptions options;
  const std::vector<ScanFeatures> features = features_of(scans, options);
  for (std::size_t a = 0; a < scans.size(); ++a) {
    for (std::size_t b = a + 1; b < scans.size(); ++b) {
      const std::vector<ModelScan> model{{features[a].surface.get(), {}}};
      std::vector<RigidTransform> starts;
      for (const PoseHypothesis& h : align_pair(features[b], features[a], options.search.align)) {
        starts.push_back(h.target_from_source);
      }
      for (const ModelFit& fit : fit_to_model(*features[b].surface, model, starts, options.search.fit)) {
        const bench::PairError error = bench::pair_error(scans[a], scans[b], fit.model_from_scanner);
        std::printf("fit %llu %zu %zu %s turn %.2f shift %.2f ", static_cast<unsigned long long>(seed), a, b,
                    error.wrong() ? "wrong" : "right", error.turn_deg, error.shift_mm);
        print_evidence(fit, options);
        std::printf("\n");
      }
    }
  }
}

void run(const Arguments& arguments, std::uint64_t seed, Sums& sums) {
  sim::TabletOptions tablet = bench::random_tablet(seed, arguments.kind, std::max(0.1, arguments.spacing_mm));
  if (arguments.size_mm.size() == 3) {
    tablet.size_mm = {arguments.size_mm[0], arguments.size_mm[1], arguments.size_mm[2]};
  }
  const bench::Pins pins = arguments.pins == "labelled"     ? bench::Pins::kLabelled
                           : arguments.pins == "unlabelled" ? bench::Pins::kUnlabelled
                                                            : bench::Pins::kNone;
  std::vector<bench::TrueScan> scans = bench::true_scans(tablet, {.spacing_mm = arguments.spacing_mm,
                                                                  .noise_mm = arguments.noise_mm,
                                                                  .views = arguments.views,
                                                                  .seed = seed,
                                                                  .pins = pins,
                                                                  .gripped_every = arguments.gripped_every});
  const PinSet pin_set = bench::pin_set(scans, pins);
  const auto has_moved = [&](int k) {
    return arguments.moved_every > 0 && k % arguments.moved_every == arguments.moved_every / 2;
  };
  Random random(seed_for(seed, 78));
  for (int k = 0; k < arguments.views; ++k) {
    if (has_moved(k)) {
      auto& scan = scans[static_cast<std::size_t>(k)];
      const Eigen::Vector3d shift_mm = arguments.moved_mm * random.normal3().normalized();
      const Eigen::Vector3d turn_deg = 0.2 * random.normal3().normalized();
      scan.grid = bench::moved_scan(*scan.grid, {turn_deg, shift_mm, random.uniform(0.3, 0.7)});
    }
  }
  if (arguments.at_truth) {
    judge_truth(scans);
    list_fits(scans, seed);
  }
  JobContext job;
  Registrar registrar;
  double slowest_s = 0;
  double add_s = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const auto start = std::chrono::steady_clock::now();
    registrar.add(static_cast<int>(k), scans[k].grid, pins == bench::Pins::kNone ? nullptr : &pin_set, job);
    const double took_s = seconds_since(start);
    sums.add_s.push_back(took_s);
    slowest_s = std::max(slowest_s, took_s);
    add_s += took_s;
  }
  const auto start = std::chrono::steady_clock::now();
  if (!registrar.finalize(job)) {
    std::fprintf(stderr, "registration was stopped\n");
    std::exit(2);
  }
  const double final_s = seconds_since(start);
  sums.final_s.push_back(final_s);

  int registered = 0, unsure = 0, failed = 0, wrong = 0;
  const ScanPose* first = nullptr;
  std::vector<accuracy::PosePair> pairs;
  const std::vector<ScanPose> poses = registrar.poses();
  double nees = 0;
  for (const ScanPose& pose : poses) {
    const bench::TrueScan& scan = scans[static_cast<std::size_t>(pose.id)];
    if (arguments.verbose) {
      std::printf("    %2d %-10s overlap %.2f sigma %.4f rms %.4f %s%s\n", pose.id, to_string(pose.status),
                  pose.overlap, pose.sigma_mm, pose.rms_mm, pose.reason.c_str(), pose.warning.c_str());
    }
    const bool is_registered = pose.status == PoseStatus::kRegistered;
    if (has_moved(pose.id)) {
      ++sums.moved;
      sums.moved_registered += is_registered ? 1 : 0;
      sums.moved_warned += pose.warning.empty() ? 0 : 1;
    } else if (!pose.warning.empty()) {
      ++sums.warned;
      std::printf("WARNED seed %llu scan %d: %s\n", static_cast<unsigned long long>(seed), pose.id,
                  pose.warning.c_str());
    }
    if (!is_registered) {
      (pose.status == PoseStatus::kUnsure ? unsure : failed) += 1;
      continue;
    }
    ++registered;
    accuracy::PosePair pair{{}, scan.tablet_from_scanner, pose.model_from_scanner};
    for (std::size_t i = 0; i < scan.grid->size(); i += 37) {
      if (scan.grid->valid[i] != 0) {
        pair.points_mm.push_back(scan.grid->point(i).cast<double>());
      }
    }
    pairs.push_back(std::move(pair));
    if (first == nullptr) {
      first = &pose;
      continue;
    }
    const bench::TrueScan& base = scans[static_cast<std::size_t>(first->id)];
    const bench::PairError error = bench::pair_error(scans, *first, pose);
    if (error.wrong()) {
      ++wrong;
      std::printf("WRONG seed %llu scan %d: %.2f degrees %.2f mm off, overlap %.2f\n",
                  static_cast<unsigned long long>(seed), pose.id, error.turn_deg, error.shift_mm,
                  pose.overlap);
      continue;
    }
    if (pose.covariance) {
      Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& p : pairs.back().points_mm) {
        centroid += p / static_cast<double>(pairs.back().points_mm.size());
      }
      const RigidTransform truth =
          first->model_from_scanner * base.tablet_from_scanner.inverse() * scan.tablet_from_scanner;
      sums.nees.push_back(accuracy::normalised_error(pose, truth, centroid));
      nees += sums.nees.back() / std::max<std::size_t>(1, scans.size() - 1);
    }
  }
  std::vector<double> displacement;
  if (wrong == 0 && pairs.size() > 1) {
    const RigidTransform gauge = accuracy::truth_from_model(pairs);
    for (const accuracy::PosePair& pair : pairs) {
      const accuracy::PoseError error = accuracy::pose_error(pair, gauge);
      displacement.insert(displacement.end(), error.displacements_mm.begin(), error.displacements_mm.end());
    }
  }
  double square = 0;
  for (const double d : displacement) {
    square += d * d / static_cast<double>(displacement.size());
  }
  std::printf(
      "%-9s %4llu  %2.0f x %2.0f x %2.0f mm  pins %-10s registered %2d/%zu unsure %d failed %d wrong %d  "
      "displaced rms %.1f, 95 %% %.1f um  nees %.2f  add %.2f s (worst %.2f) final %.2f s\n",
      arguments.kind.c_str(), static_cast<unsigned long long>(seed), tablet.size_mm.x(), tablet.size_mm.y(),
      tablet.size_mm.z(), arguments.pins.c_str(), registered, scans.size(), unsure, failed, wrong,
      1000 * std::sqrt(square), 1000 * quantile(displacement, 0.95), nees, add_s, slowest_s, final_s);
  std::fflush(stdout);
  ++sums.tablets;
  sums.whole_tablets += registered == static_cast<int>(scans.size()) && wrong == 0 ? 1 : 0;
  sums.scans += static_cast<int>(scans.size());
  sums.registered += registered;
  sums.unsure += unsure;
  sums.failed += failed;
  sums.wrong += wrong;
  sums.displacement_mm.insert(sums.displacement_mm.end(), displacement.begin(), displacement.end());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"registration of simulated tablets against the truth"};
  Arguments arguments;
  app.add_option("--kind", arguments.kind, "of the tablets")->check(bench::one_of(bench::kTabletKinds));
  app.add_option("--pins", arguments.pins)->check(CLI::IsMember({"none", "labelled", "unlabelled"}));
  app.add_option("--first", arguments.first_seed, "first seed");
  app.add_option("--tablets", arguments.tablets, "how many");
  app.add_option("--views", arguments.views, "scans of each");
  app.add_option("--spacing", arguments.spacing_mm, "of the scans, mm");
  app.add_option("--noise", arguments.noise_mm, "mm");
  app.add_option("--size", arguments.size_mm, "width height thickness, mm; else random")->expected(3);
  app.add_option("--gripped-every", arguments.gripped_every,
                 "fingers hold the tablet in each so manieth scan")
      ->check(CLI::Range(0, 100));
  app.add_option("--moved-every", arguments.moved_every, "each so manieth scan moves in its middle")
      ->check(CLI::Range(0, 100));
  app.add_option("--moved", arguments.moved_mm, "by so much, mm, and 0.2 degrees");
  app.add_flag("-v,--verbose", arguments.verbose, "each scan");
  app.add_flag("--at-truth", arguments.at_truth,
               "also judge the true poses and list every pose that pairs are found in");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  Sums sums;
  for (std::uint64_t k = 0; k < arguments.tablets; ++k) {
    run(arguments, arguments.first_seed + k, sums);
  }
  double square = 0;
  for (const double d : sums.displacement_mm) {
    square += d * d / static_cast<double>(sums.displacement_mm.size());
  }
  std::printf(
      "tablets %d, all scans registered in %d (%.1f %%); scans %d: registered %d unsure %d failed %d WRONG "
      "%d\n"
      "displaced rms %.1f um, 95 %% %.1f um; normalised squared error mean %.2f, median %.2f (1 and 0.89 "
      "when calibrated)\n"
      "warned of %d scans that did not move; of %d that did: %d registered, warned of %d\n"
      "a scan: mean %.2f s, 95 %% %.2f s, worst %.2f s; final: mean %.2f s, worst %.2f s\n",
      sums.tablets, sums.whole_tablets, 100.0 * sums.whole_tablets / std::max(1, sums.tablets), sums.scans,
      sums.registered, sums.unsure, sums.failed, sums.wrong, 1000 * std::sqrt(square),
      1000 * quantile(sums.displacement_mm, 0.95), mean(sums.nees), quantile(sums.nees, 0.5), sums.warned,
      sums.moved, sums.moved_registered, sums.moved_warned, mean(sums.add_s), quantile(sums.add_s, 0.95),
      quantile(sums.add_s, 1.0), mean(sums.final_s), quantile(sums.final_s, 1.0));
  return sums.wrong == 0 ? 0 : 1;
}
