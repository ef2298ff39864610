// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Seconds by stage of stitching scans of a simulated tablet, in memory, and the peak of memory; one line a
// size, so that it shows whether time grows with the samples.
//   dubsar-stitch-speed [--scans 12] [--repeat 1] MILLIONS …   samples of one scan
//   dubsar-stitch-speed --adding MILLIONS                      seconds to take up each scan (no mesh yet)
//   dubsar-stitch-speed --write FOLDER MILLIONS                the scans and poses.json, for `dubsar stitch`

#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/options.h"
#include "bench/support/peak_memory.h"
#include "bench/support/simulated_views.h"
#include "bench/support/statistics.h"
#include "core/heap.h"
#include "core/stage_times.h"
#include "formats/grid_ply.h"
#include "formats/poses_json.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;
using Clock = std::chrono::steady_clock;

/// The most that was resident since this was last asked; 0 where the kernel does not tell.
double peak_since_asked_gib() {
  double kib = 0;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") {
      status >> kib;
      break;
    }
  }
  std::ofstream("/proc/self/clear_refs") << "5";
  return kib / (1024.0 * 1024.0);
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Learns from a job's progress how long each stage takes.
class StageClock {
 public:
  void enter(std::string_view stage) {
    const Clock::time_point now = Clock::now();
    const double cpu_s = cpu_seconds();
    const double peak_gib = peak_since_asked_gib();
    if (!stages_.empty()) {
      stages_[at_].peak_gib = std::max(stages_[at_].peak_gib, peak_gib);
      stages_[at_].wall_s += std::chrono::duration<double>(now - since_).count();
      stages_[at_].cpu_s += cpu_s - cpu_since_s_;
    }
    since_ = now;
    cpu_since_s_ = cpu_s;
    for (at_ = 0; at_ < stages_.size() && stages_[at_].name != stage; ++at_) {
    }
    if (at_ == stages_.size()) {
      stages_.push_back({std::string(stage)});
    }
  }
  void print() const {
    for (const Stage& stage : stages_) {
      if (stage.peak_gib > 0) {
        std::printf("    %-24s %8.3f s %8.3f s of processors %6.2f GiB\n", stage.name.c_str(), stage.wall_s,
                    stage.cpu_s, stage.peak_gib);
      }
    }
  }

 private:
  struct Stage {
    std::string name;
    double wall_s = 0;
    double cpu_s = 0;
    double peak_gib = 0;
  };
  std::vector<Stage> stages_;
  std::size_t at_ = 0;
  Clock::time_point since_;
  double cpu_since_s_ = 0;
};

/// The last scan comes to the others while the station runs.
int measure_adding(double millions, int scans) {
  const SimulatedViews views = make_views_of_millions(scans, millions);
  const std::vector<PlacedScan> placed = views.placed();
  const JobContext job;
  Stitcher stitcher;
  for (const PlacedScan& scan : placed) {
    const auto start = Clock::now();
    const double cpu_start_s = cpu_seconds();
    Status added = stitcher.add(scan, job);
    added = added ? stitcher.update(job) : added;
    if (!added) {
      std::fprintf(stderr, "%s\n", added.error().line().c_str());
      return 4;
    }
    std::printf("scan %d of %.2f million samples added: %.3f s, %.3f s of processors\n", scan.id + 1,
                1e-6 * static_cast<double>(scan.grid->valid_count()), seconds_since(start),
                cpu_seconds() - cpu_start_s);
  }
  return 0;
}

int write_files(double millions, int scans, const std::filesystem::path& folder) {
  const SimulatedViews views = make_views_of_millions(scans, millions);
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  std::vector<ScanPose> poses;
  Status written;
  for (std::size_t k = 0; k < views.grids.size() && written; ++k) {
    ScanPose& pose = poses.emplace_back();
    pose.file = "scan" + std::to_string(k) + ".ply";
    pose.model_from_scanner = views.poses[k];
    pose.status = PoseStatus::kRegistered;
    written = write_grid_ply(folder / pose.file, *views.grids[k]);
  }
  written = written ? write_poses(folder / "poses.json", poses) : written;
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().line().c_str());
    return 4;
  }
  return 0;
}

int measure(double millions, int scans, int repeat) {
  const SimulatedViews views = make_views_of_millions(scans, millions);
  const std::vector<PlacedScan> placed = views.placed();
  const auto samples = static_cast<double>(views.samples());
  for (int k = 0; k < repeat; ++k) {
    StageClock stages;
    stages.enter("scans in memory");
    const JobContext job([&](std::string_view stage, double) { stages.enter(stage); });
    const auto start = Clock::now();
    const double cpu_start_s = cpu_seconds();
    const Result<Mesh> mesh = stitch(placed, {}, job);
    const double took_s = seconds_since(start);
    const double cpu_s = cpu_seconds() - cpu_start_s;
    stages.enter("end");
    if (!mesh) {
      std::fprintf(stderr, "%s\n", mesh.error().line().c_str());
      return 4;
    }
    std::printf(
        "%d scans, %.2f million samples: %.2f s, %.2f million samples/s; %.2f s of processors, %.2f us a "
        "sample; %.2f million faces; peak %.2f GiB\n",
        scans, 1e-6 * samples, took_s, 1e-6 * samples / took_s, cpu_s, 1e6 * cpu_s / samples,
        1e-6 * static_cast<double>(mesh->faces.size()), peak_gib());
    stages.print();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  map_large_blocks();
  std::vector<double> millions{1.0};
  int scans = 12;
  int repeat = 1;
  CLI::App app("seconds by stage of stitching");
  app.add_option("millions", millions);
  app.add_option("--scans", scans);
  app.add_option("--repeat", repeat);
  bool adding = false;
  std::string folder;
  app.add_option("--write", folder, "no stitching: the scans into this folder, with their poses");
  app.add_flag("--adding", adding, "scan by scan instead, as while scanning");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  std::printf("%d threads\n", tbb::info::default_concurrency());
  for (const double m : millions) {
    const int status = !folder.empty() ? write_files(m, scans, folder)
                       : adding        ? measure_adding(m, scans)
                                       : measure(m, scans, repeat);
    if (status != 0) {
      return status;
    }
  }
  return 0;
}
