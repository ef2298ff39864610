// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sparse flags (seed 001, 3.3, steps 1 and 2).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "planning/sparse_flags.h"

namespace dubsar::bench {
namespace {

void flags(benchmark::State& state) {
  const RangeGrid& grid = *million_sample_views(1).grids[0];
  for (auto _ : state) {
    benchmark::DoNotOptimize(flag_sparse(grid));
  }
  report_rate(state, static_cast<double>(grid.valid_count()), 100e6,
              "reference: 100 million samples/s wanted");
}
BENCHMARK(flags)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace dubsar::bench
