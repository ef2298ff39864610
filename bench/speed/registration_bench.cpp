// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// One grid of a million samples into a model of ten (seed 001, 3.2).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
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
    registrar.remove(10);
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

}  // namespace
}  // namespace dubsar::bench
