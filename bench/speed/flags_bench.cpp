// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sparse flags and clearing (seed 001, 3.3).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"

namespace dubsar::bench {
namespace {

void flags(benchmark::State& state) {
  const RangeGrid& grid = *million_sample_views(1).grids[0];
  for (auto _ : state) {
    benchmark::DoNotOptimize(flag_sparse(grid));
  }
  report_rate(state, static_cast<double>(grid.valid_count()), 30e6, "reference: 30 million samples/s wanted");
}
BENCHMARK(flags)->Unit(benchmark::kMillisecond)->UseRealTime();

void clear_against_ten(benchmark::State& state) {
  const SimulatedViews& views = million_sample_views(11);
  const std::vector<PlacedScan> placed = views.placed();
  ClearedMap map;
  for (std::size_t k = 0; k < 10; ++k) {
    map.add(placed[k]);
  }
  for (auto _ : state) {
    map.add(placed[10]);
    state.PauseTiming();
    map.remove(10);
    state.ResumeTiming();
  }
  report_rate(state, static_cast<double>(views.grids[10]->valid_count()), 1e6 / 0.15,
              "reference: a million samples in 150 ms");
}
BENCHMARK(clear_against_ten)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace dubsar::bench
