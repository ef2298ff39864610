// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// One grid of a million samples into a model of ten (seed 001, 3.2).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "registration/registrar.h"

namespace dubsar::bench {
namespace {

void register_into_ten(benchmark::State& state) {
  const SimulatedViews& views = million_sample_views(11);
  JobContext job;
  Registrar registrar;
  for (int id = 0; id < 10; ++id) {
    registrar.add(id, views.grids[static_cast<std::size_t>(id)], nullptr, job);
  }
  double registered = 0;
  for (auto _ : state) {
    registered = registrar.add(10, views.grids[10], nullptr, job).status == PoseStatus::kRegistered ? 1 : 0;
    state.PauseTiming();
    registrar.remove(10);
    state.ResumeTiming();
  }
  state.counters["registered"] = registered;
  report_rate(state, static_cast<double>(views.grids[10]->valid_count()), 1e6 / 2.0,
              "reference: a million samples in 2 s");
}
BENCHMARK(register_into_ten)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);

}  // namespace
}  // namespace dubsar::bench
