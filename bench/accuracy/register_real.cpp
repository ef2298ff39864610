// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// register_real FOLDER CONF [MM_PER_UNIT]: registers the range grids of a folder in name order with no hints
// and prints each pose's error against the published .conf after one rigid gauge alignment.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "core/units.h"
#include "registration/registrar.h"
#include "tests/registration/support/gauge.h"
#include "tests/registration/support/read_range_ply.h"

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: register_real FOLDER CONF [MM_PER_UNIT]\n");
    return 2;
  }
  using Clock = std::chrono::steady_clock;
  const std::filesystem::path folder = argv[1];
  const double mm_per_unit = argc > 3 ? std::atof(argv[3]) : 1000.0;
  const auto truth = dubsar::testing::read_conf(folder / argv[2], mm_per_unit);
  std::vector<std::shared_ptr<const dubsar::RangeGrid>> grids;
  for (dubsar::RangeGrid& grid : dubsar::testing::read_folder(folder, mm_per_unit)) {
    grids.push_back(std::make_shared<const dubsar::RangeGrid>(std::move(grid)));
  }
  dubsar::Registrar registrar;
  dubsar::JobContext job;
  const auto seconds = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  const Clock::time_point start = Clock::now();
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const Clock::time_point before = Clock::now();
    const dubsar::ScanPose pose = registrar.add(static_cast<int>(k), grids[k], nullptr, job);
    std::printf("%-26s %-10s %.3f s  %s\n", pose.file.c_str(), dubsar::to_string(pose.status),
                seconds(before), pose.reason.c_str());
  }
  const double online = seconds(start);
  if (!registrar.finalize(job)) {
    return 1;
  }
  const double all = seconds(start);
  const auto errors = dubsar::testing::gauge_errors(registrar.poses(), truth, grids);
  std::printf("\n%-26s %-10s %8s %8s %8s %8s %8s\n", "scan", "status", "deg", "mm", "rms mm", "sigma mm",
              "overlap");
  for (const auto& e : errors) {
    std::printf("%-26s %-10s %8.3f %8.3f %8.3f %8.4f %8.3f  %s\n", e.pose.file.c_str(),
                dubsar::to_string(e.pose.status), dubsar::deg_from_rad(e.turn_rad), e.shift_mm, e.pose.rms_mm,
                e.pose.sigma_mm, e.pose.overlap, e.pose.reason.c_str());
  }
  std::printf("online %.2f s, with finalize %.2f s\n", online, all);
  return 0;
}
