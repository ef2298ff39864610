// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How well the surface was sampled, for the checklist.

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "planning/surface_quality.h"
#include "triangulation/stitcher.h"

namespace dubsar::bench {
namespace {

void quality_of_eleven(benchmark::State& state) {
  const SimulatedViews& views = million_sample_views(11);
  const JobContext job;
  const std::vector<PlacedScan> placed = views.placed();
  const Result<Mesh> mesh = stitch(placed, {}, job);
  if (!mesh) {
    state.SkipWithError("no mesh");
    return;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(surface_quality(placed, *mesh, ModelFaces{}));
  }
  report_rate(state, static_cast<double>(views.samples()), 20e6,
              "samples/s; reference: 20 scans of a million samples in a second");
}
BENCHMARK(quality_of_eleven)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace dubsar::bench
