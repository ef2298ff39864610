// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// One grid of a million samples into a model of ten (seed 001, 3.2).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "core/random.h"
#include "registration/registrar.h"

namespace dubsar::bench {
namespace {

/// The grid as a device without a stage gives it.
std::shared_ptr<const RangeGrid> without_nominal(const RangeGrid& grid) {
  RangeGrid copy = grid;
  copy.nominal.reset();
  return std::make_shared<const RangeGrid>(std::move(copy));
}

/// hints: the scan comes with the pose that a hand turn was asked for. Without, from its surface alone.
void register_into_ten(benchmark::State& state, bool hints) {
  const SimulatedViews& views = million_sample_views(11);
  JobContext job;
  Registrar registrar;
  for (int id = 0; id < 10; ++id) {
    registrar.add(id, views.grids[static_cast<std::size_t>(id)], nullptr, job);
  }
  const auto grid = hints ? views.grids[10] : without_nominal(*views.grids[10]);
  double registered = 0;
  for (auto _ : state) {
    registered = registrar.add(10, grid, nullptr, job).status == PoseStatus::kRegistered ? 1 : 0;
    state.PauseTiming();
    registrar.remove(10, job);
    state.ResumeTiming();
  }
  double model = 0;
  for (const ScanPose& pose : registrar.poses()) {
    model += pose.status == PoseStatus::kRegistered ? 1 : 0;
  }
  state.counters["model"] = model;
  state.counters["registered"] = registered;
  report_rate(state, static_cast<double>(grid->valid_count()), 1e6 / 2.0,
              "reference: a million samples in 2 s");
}
BENCHMARK_CAPTURE(register_into_ten, nominal, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(3);
BENCHMARK_CAPTURE(register_into_ten, no_hints, false)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(2);

/// The part of it that is done before any pose is looked for: normals, levels, lookups, samples.
void prepare_scan(benchmark::State& state) {
  const RangeGrid& grid = *million_sample_views(11).grids[10];
  ScanSurfaceOptions options;
  for (auto _ : state) {
    options.scale_mm = surface_scale_mm(grid);
    benchmark::DoNotOptimize(make_scan_surface(grid, {}, options));
  }
  report_rate(state, static_cast<double>(grid.valid_count()), 1e6 / 2.0,
              "reference: a million samples in 2 s");
}
BENCHMARK(prepare_scan)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Fifteen scans around an object, each measured against the next four, relaxed from half a millimetre off.
void relax_fifteen(benchmark::State& state) {
  constexpr std::size_t kScans = 15;
  Random random(1);
  std::vector<RigidTransform> truth;
  std::vector<RigidTransform> start;
  for (std::size_t k = 0; k < kScans; ++k) {
    truth.push_back(RigidTransform::from_twist({0, 0.42 * static_cast<double>(k), 0}, {1, 2, 3}));
    const Eigen::Vector3d turn = 0.005 * random.normal3();
    start.push_back(
        (RigidTransform::from_twist(turn, 0.5 * random.normal3()) * truth.back()).orthonormalised());
  }
  std::vector<PairConstraint> pairs;
  for (std::size_t a = 0; a < kScans; ++a) {
    for (std::size_t step = 1; step <= 4; ++step) {
      const std::size_t b = (a + step) % kScans;
      const RigidTransform off = RigidTransform::from_twist({0, 0, 0}, 0.01 * random.normal3());
      PairConstraint& pair = pairs.emplace_back();
      pair.a = a;
      pair.b = b;
      pair.a_from_b = off * truth[a].inverse() * truth[b];
      pair.information = 1e4 * Matrix6d::Identity();
    }
  }
  JobContext job;
  for (auto _ : state) {
    benchmark::DoNotOptimize(relax(start, std::vector<bool>(kScans, false),
                                   std::vector<Eigen::Vector3d>(kScans, {0, 0, 10}), pairs, {}, job));
  }
  report_rate(state, static_cast<double>(kScans), 15.0, "reference: fifteen scans in a second");
}
BENCHMARK(relax_fifteen)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace dubsar::bench
