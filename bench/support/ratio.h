// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <benchmark/benchmark.h>

namespace dubsar::bench {

/// Reports items per second of wall clock and their ratio to a reference rate, which the label names.
inline void report_rate(benchmark::State& state, double items_per_iteration, double reference_per_s,
                        const char* reference) {
  state.counters["samples/s"] =
      benchmark::Counter(items_per_iteration, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["ratio"] = benchmark::Counter(items_per_iteration / reference_per_s,
                                               benchmark::Counter::kIsIterationInvariantRate);
  state.SetLabel(reference);
}

}  // namespace dubsar::bench
