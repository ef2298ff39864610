// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator waits for: clearing (seed 001, 3.3, step 3), and the whole way from the last profile of a
// scan to the red map and the next view.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "acquisition/session_store.h"
#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"
#include "registration/registrar.h"
#include "station/planning_stage.h"
#include "station/station_scan.h"

namespace dubsar::bench {
namespace {

constexpr std::size_t kModel = 10;  ///< scans that are there before the one that is timed
constexpr int kNew = static_cast<int>(kModel);

/// One grid into a map of ten, both ways.
void clear_against_ten(benchmark::State& state, const SimulatedViews& views, double wanted_s) {
  const std::vector<PlacedScan> placed = views.placed();
  ClearedMap map;
  for (std::size_t k = 0; k < kModel; ++k) {
    map.add(placed[k]);
  }
  for (auto _ : state) {
    map.add(placed[kModel]);
    state.PauseTiming();
    map.remove(kNew);
    state.ResumeTiming();
  }
  const auto samples = static_cast<double>(views.grids[kModel]->valid_count());
  report_rate(state, samples, samples / wanted_s, "ratio 1: the time that is wanted");
}

void clear_million_against_ten(benchmark::State& state) {
  clear_against_ten(state, million_sample_views(11), 0.150);
}
void clear_four_million_against_ten(benchmark::State& state) {
  clear_against_ten(state, views_of_millions(4), 0.250);
}

enum class Nominal { kMotor, kHand };

/// The pose as motors know it, all scans of one placement; or as a hand turn leaves it, each its own.
NominalPose nominal_of(const SimulatedViews& views, std::size_t k, Nominal kind) {
  if (kind == Nominal::kHand) {
    return *views.grids[k]->nominal;
  }
  Random motor(seed_for(11, k));
  const Eigen::Vector3d turn_rad = 0.0001 * motor.normal3();
  const RigidTransform off = RigidTransform::from_twist(turn_rad, 0.01 * motor.normal3());
  return {.tablet_from_scanner = off * views.poses[k]};
}

/// A session that the benchmark writes to and takes away again.
class ScratchSession {
 public:
  ScratchSession()
      : folder_(std::filesystem::temp_directory_path() / ("dubsar-bench-" + std::to_string(::getpid()))),
        store_(SessionStore::open_or_create(folder_)) {}
  ~ScratchSession() {
    store_ = fail(ErrorKind::kInternal, "closed");
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchSession(const ScratchSession&) = delete;
  ScratchSession& operator=(const ScratchSession&) = delete;
  bool keep(const RangeGrid& grid) { return store_ && store_->add_grid(grid).has_value(); }

 private:
  std::filesystem::path folder_;
  Result<SessionStore> store_;
};

/// Wall clock by stage, and processor time of the whole program meanwhile (which tells what a busy machine
/// hides); the mean of each as a counter in milliseconds.
class StagesSpent {
 public:
  template <class Work>
  auto time(const char* stage, const Work& work) {
    const Stop stop{spent_in(stage)};
    return work();
  }
  void report(benchmark::State& state) const {
    const auto count = static_cast<double>(state.iterations());
    for (const auto& [stage, spent] : spent_) {
      state.counters[stage + "_ms"] = 1e3 * spent.wall_s / count;
      state.counters[stage + "_cpu_ms"] = 1e3 * spent.cpu_s / count;
    }
  }

 private:
  struct Spent {
    double wall_s = 0, cpu_s = 0;
  };
  struct Stop {
    Spent& spent;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    std::clock_t cpu_start = std::clock();
    ~Stop() {
      spent.wall_s += seconds_since(start);
      spent.cpu_s += static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    }
  };
  Spent& spent_in(const char* stage) {
    const std::scoped_lock lock(mutex_);
    return spent_[stage];
  }
  std::mutex mutex_;
  std::map<std::string, Spent> spent_;  ///< its entries stay where they are
};

/// As the engine goes: the flags of the last rows, pins out, registration while the grid is stored, clearing,
/// red map and next views. The mesh comes after them.
void profile_to_next_view(benchmark::State& state, int millions, Nominal kind) {
  const SimulatedViews& views = views_of_millions(millions);
  JobContext job;
  Registrar registrar;
  PlanningStage planning;
  const auto with_nominal = [&](std::size_t k) {
    RangeGrid grid = *views.grids[k];
    grid.nominal = nominal_of(views, k, kind);
    return grid;
  };
  for (std::size_t k = 0; k < kModel; ++k) {
    const StationScan scan = prepare_scan(static_cast<int>(k), with_nominal(k), std::nullopt, views.flags[k]);
    registrar.add(scan.id, scan.measured, nullptr, job);
    planning.add(scan);
  }
  const std::vector<ScanPose> before = registrar.poses();
  if (!planning.place(before, false, job)) {
    state.SkipWithError("the model could not be placed");
    return;
  }
  ScratchSession session;
  StagesSpent times;
  double registered = 0;
  double next = 0;
  for (auto _ : state) {
    state.PauseTiming();
    RangeGrid grid = with_nominal(kModel);
    SparseFlagger flagger(grid.cols, grid.spacing_mm);
    SampleFlags flags;
    flagger.update(grid, flags);
    state.ResumeTiming();

    const StationScan scan = times.time("prepare", [&] {
      flagger.finish(grid, flags);
      return prepare_scan(kNew, std::move(grid), std::nullopt, std::move(flags));
    });
    bool stored = false;
    ScanPose pose;
    times.time("store_and_register", [&] {
      const std::jthread storing(
          [&] { stored = times.time("store", [&] { return session.keep(*scan.measured); }); });
      pose = times.time("register", [&] { return registrar.add(kNew, scan.measured, nullptr, job); });
    });
    const Status placed = times.time("clear", [&] {
      planning.add(scan);
      return planning.place(registrar.poses(), false, job);
    });
    const Result<RedMap> map =
        times.time("red_map_and_next_view", [&] { return planning.red_map(nullptr, job); });

    state.PauseTiming();
    if (!stored || !placed || !map) {
      state.SkipWithError("a stage failed");
      break;
    }
    registered = pose.status == PoseStatus::kRegistered ? 1 : 0;
    next = static_cast<double>(map->next.size());
    registrar.remove(kNew, job);
    if (!planning.place(before, false, job)) {
      state.SkipWithError("the model could not be put back");
      break;
    }
    state.ResumeTiming();
  }
  const auto on = std::count_if(before.begin(), before.end(),
                                [](const ScanPose& p) { return p.status == PoseStatus::kRegistered; });
  state.counters["model"] = static_cast<double>(on);
  state.counters["registered"] = registered;
  state.counters["next_views"] = next;
  times.report(state);
  const auto samples = static_cast<double>(views.grids[kModel]->valid_count());
  report_rate(state, samples, samples / 1.0, "ratio 1: a second");
}

void arguments(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}

BENCHMARK(clear_million_against_ten)->Apply(arguments);
BENCHMARK_CAPTURE(profile_to_next_view, million_motor, 1, Nominal::kMotor)->Apply(arguments)->Iterations(3);
BENCHMARK_CAPTURE(profile_to_next_view, million_hand, 1, Nominal::kHand)->Apply(arguments)->Iterations(3);
BENCHMARK(clear_four_million_against_ten)->Apply(arguments);
BENCHMARK_CAPTURE(profile_to_next_view, four_million_motor, 4, Nominal::kMotor)
    ->Apply(arguments)
    ->Iterations(3);
BENCHMARK_CAPTURE(profile_to_next_view, four_million_hand, 4, Nominal::kHand)
    ->Apply(arguments)
    ->Iterations(3);

}  // namespace
}  // namespace dubsar::bench
