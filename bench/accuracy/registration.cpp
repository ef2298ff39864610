// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-registration: registration of simulated tablets against the truth, with nothing told of the poses.
// One line per tablet, then the sums: how many scans and tablets were registered, how far the surface is
// displaced after relaxation, whether the covariances are what they claim, how long a scan took. Exits 1 when
// an accepted pose is wrong.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/accuracy/gauge.h"
#include "bench/support/true_scans.h"
#include "registration/registrar.h"

namespace {

using namespace dubsar;

struct Arguments {
  std::string kind = "text";
  std::string pins = "none";
  std::uint64_t first_seed = 1;
  std::uint64_t tablets = 4;
  int views = 12;
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  std::vector<double> size_mm;
  bool verbose = false;
};

struct Sums {
  int tablets = 0, whole_tablets = 0, scans = 0, registered = 0, unsure = 0, failed = 0, wrong = 0;
  std::vector<double> displacement_mm;  ///< of points on the surface, scans of the model only
  std::vector<double> tablet_rms_mm;
  std::vector<double> nees;  ///< normalised squared error of each registered pose, per degree of freedom
  std::vector<double> add_s;
  std::vector<double> final_s;
};

double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0;
  }
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Squared error of the pose against the truth in parts of its covariance, per degree of freedom. The twist
/// is the covariance's: about the scan's centroid in the model frame. `truth_from_first` fixes the gauge as
/// registration does: the first scan is exact.
double normalised_error(const ScanPose& pose, const RigidTransform& model_from_scanner_true,
                        const Eigen::Vector3d& centroid_mm) {
  const RigidTransform off = pose.model_from_scanner * model_from_scanner_true.inverse();
  const Eigen::AngleAxisd turn(off.rotation);
  const Eigen::Vector3d at = model_from_scanner_true * centroid_mm;
  Eigen::Matrix<double, 6, 1> twist;
  twist << turn.angle() * turn.axis(), off * at - at;
  return twist.dot(pose.covariance->ldlt().solve(twist)) / 6.0;
}

void run(const Arguments& arguments, std::uint64_t seed, Sums& sums) {
  sim::TabletOptions tablet = bench::random_tablet(seed, arguments.kind, std::max(0.1, arguments.spacing_mm));
  if (arguments.size_mm.size() == 3) {
    tablet.size_mm = {arguments.size_mm[0], arguments.size_mm[1], arguments.size_mm[2]};
  }
  const bench::Pins pins = arguments.pins == "labelled"     ? bench::Pins::kLabelled
                           : arguments.pins == "unlabelled" ? bench::Pins::kUnlabelled
                                                            : bench::Pins::kNone;
  const std::vector<bench::TrueScan> scans = bench::true_scans(
      tablet, {arguments.spacing_mm, arguments.noise_mm, arguments.views, {}, seed, pins, 0});
  const PinSet pin_set = bench::pin_set(scans, pins);
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
      std::printf("    %2d %-10s overlap %.2f sigma %.4f rms %.4f %s\n", pose.id, to_string(pose.status),
                  pose.overlap, pose.sigma_mm, pose.rms_mm, pose.reason.c_str());
    }
    if (pose.status != PoseStatus::kRegistered) {
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
    const bench::PairError error =
        bench::pair_error(base, scan, first->model_from_scanner.inverse() * pose.model_from_scanner);
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
      sums.nees.push_back(normalised_error(pose, truth, centroid));
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
  app.add_option("--kind", arguments.kind, "text, blank, worn, tiny or symmetric");
  app.add_option("--pins", arguments.pins, "none, labelled or unlabelled");
  app.add_option("--first", arguments.first_seed, "first seed");
  app.add_option("--tablets", arguments.tablets, "how many");
  app.add_option("--views", arguments.views, "scans of each");
  app.add_option("--spacing", arguments.spacing_mm, "of the scans, mm");
  app.add_option("--noise", arguments.noise_mm, "mm");
  app.add_option("--size", arguments.size_mm, "width height thickness, mm; else random")->expected(3);
  app.add_flag("-v,--verbose", arguments.verbose, "each scan");
  CLI11_PARSE(app, argc, argv);
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
      "a scan: mean %.2f s, 95 %% %.2f s, worst %.2f s; final: mean %.2f s, worst %.2f s\n",
      sums.tablets, sums.whole_tablets, 100.0 * sums.whole_tablets / std::max(1, sums.tablets), sums.scans,
      sums.registered, sums.unsure, sums.failed, sums.wrong, 1000 * std::sqrt(square),
      1000 * quantile(sums.displacement_mm, 0.95), mean(sums.nees), quantile(sums.nees, 0.5),
      mean(sums.add_s), quantile(sums.add_s, 0.95), quantile(sums.add_s, 1.0), mean(sums.final_s),
      quantile(sums.final_s, 1.0));
  return sums.wrong == 0 ? 0 : 1;
}
