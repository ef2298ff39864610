// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// dubsar-rows: long simulated tablets, scanned piece by piece in a row of scans of which each shares a
// quarter with the next, registered with nothing told of the poses. One line per row, then the sums: how many
// scans were registered, how much too far each lies along and across the row, how much too long the tablet
// came out, and whether the covariances hold that, by the number of links from the scan that is the model
// frame. Exits 1 when an accepted pose is wrong.
//   dubsar-rows --tablets 8 --first 1 --noise 0.004

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "bench/accuracy/gauge.h"
#include "bench/support/options.h"
#include "bench/support/registered_poses.h"
#include "bench/support/row_of_scans.h"
#include "bench/support/statistics.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Sums {
  int scans = 0, registered = 0, wrong = 0;
  std::vector<double> along_um, across_um;  ///< of each scan's place beside the one before it, at the seam
  std::vector<double> too_long_um;          ///< of whole rows
  std::map<int, std::vector<double>> square_of;  ///< normalised squared errors by links from the reference
};

struct Mean {
  double value = 0;
  double error = 0;  ///< its standard error
  explicit Mean(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    for (const double v : values) {
      value += v / count;
    }
    for (const double v : values) {
      error += (v - value) * (v - value) / (count * std::max(1.0, count - 1));
    }
    error = std::sqrt(error);
  }
};

Eigen::Vector3d centroid_mm(const RangeGrid& grid) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    sum += grid.valid[i] != 0 ? Eigen::Vector3d(grid.point(i).cast<double>()) : Eigen::Vector3d::Zero();
  }
  return sum / std::max(1.0, static_cast<double>(grid.valid_count()));
}

void run(const RowOptions& options, const std::vector<TrueScan>& scans, std::size_t set, Sums& sums) {
  std::vector<ScanPose> poses = bench::registered_poses(scans);
  std::erase_if(poses, [](const ScanPose& pose) { return pose.status != PoseStatus::kRegistered; });
  const auto registered = static_cast<int>(poses.size());
  // The scan that is the model frame is the one without an error of its own.
  const auto exact = std::ranges::find(poses, 0.0, &ScanPose::sigma_mm);
  const ScanPose reference = exact != poses.end() ? *exact : poses.empty() ? ScanPose{} : poses.front();
  const auto true_scan = [&](const ScanPose& pose) -> const TrueScan& {
    return scans[static_cast<std::size_t>(pose.id)];
  };
  const auto wrong = static_cast<int>(
      std::erase_if(poses, [&](const ScanPose& pose) { return pair_error(scans, reference, pose).wrong(); }));
  // Where scan b, laid by a, puts what it truly shows, in the tablet's frame.
  const auto moved = [&](const ScanPose& a, const ScanPose& b) {
    return true_scan(a).tablet_from_scanner * a.model_from_scanner.inverse() * b.model_from_scanner *
           true_scan(b).tablet_from_scanner.inverse();
  };
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const ScanPose& pose = poses[k];
    if (k > 0 && poses[k - 1].id + 1 == pose.id) {
      const Eigen::Vector3d seam_mm(options.seam_mm(pose.id), 0, 0.4 * options.size_mm.z());
      const Eigen::Vector3d off_mm = moved(poses[k - 1], pose) * seam_mm - seam_mm;
      sums.along_um.push_back(1e3 * off_mm.x());
      sums.across_um.push_back(1e3 * off_mm.y());
    }
    if (pose.id != reference.id && pose.covariance) {
      const RigidTransform truth = reference.model_from_scanner *
                                   true_scan(reference).tablet_from_scanner.inverse() *
                                   true_scan(pose).tablet_from_scanner;
      sums.square_of[std::abs(pose.id - reference.id)].push_back(
          accuracy::normalised_error(pose, truth, centroid_mm(*true_scan(pose).grid)));
    }
  }
  if (poses.size() == scans.size()) {
    const Eigen::Vector3d end_mm(0.5 * options.size_mm.x() - 1, 0, 0.4 * options.size_mm.z());
    const Eigen::Vector3d begin_mm(-end_mm.x(), 0, end_mm.z());
    sums.too_long_um.push_back(
        1e3 * ((moved(poses.front(), poses.back()) * end_mm - begin_mm).norm() - (end_mm - begin_mm).norm()));
  }
  std::printf("tablet %4llu set %zu  registered %d/%zu wrong %d\n",
              static_cast<unsigned long long>(options.seed), set, registered, scans.size(), wrong);
  std::fflush(stdout);
  sums.scans += options.scans;
  sums.registered += registered;
  sums.wrong += wrong;
}

}  // namespace

int main(int argc, char** argv) {
  RowOptions options;
  int tablets = 8;
  CLI::App app("Rows of scans along simulated tablets against the truth", "dubsar-rows");
  app.add_option("--tablets", tablets, "how many")->check(CLI::Range(1, 1000000));
  app.add_option("--first", options.seed, "first seed");
  app.add_option("--noise", options.noise_mm, "mm")->check(CLI::Range(0.0, 1.0));
  app.add_option("--spacing", options.spacing_mm, "of the scans, mm")->check(CLI::Range(0.05, 2.0));
  if (const auto status = ends_with(app, argc, argv)) {
    return *status;
  }
  Sums sums;
  for (int k = 0; k < tablets; ++k, ++options.seed) {
    const auto rows = rows_of_scans(options);
    for (std::size_t set = 0; set < rows.size(); ++set) {
      run(options, rows[set], set, sums);
    }
  }
  std::printf("scans %d: registered %d WRONG %d\n", sums.scans, sums.registered, sums.wrong);
  const auto print = [](const char* what, const std::vector<double>& values_um, const char* of) {
    const Mean mean(values_um);
    std::printf("%-34s mean %5.1f um, standard error %.1f, %zu %s\n", what, mean.value, mean.error,
                values_um.size(), of);
  };
  print("each scan too far along the row", sums.along_um, "links");
  print("each scan too far across the row", sums.across_um, "links");
  print("the tablet too long", sums.too_long_um, "whole rows");
  for (const auto& [links, squares] : sums.square_of) {
    std::printf("%d links from the reference: normalised squared error mean %.2f, median %.2f, %zu poses\n",
                links, Mean(squares).value, quantile(squares, 0.5), squares.size());
  }
  return sums.wrong == 0 ? 0 : 1;
}
