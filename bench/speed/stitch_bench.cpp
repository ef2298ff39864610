// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Grid triangulation and stitching (seed 001, 4).

#include "bench/support/ratio.h"
#include "bench/support/simulated_views.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/stitcher.h"

namespace dubsar::bench {
namespace {

void triangulate_one_grid(benchmark::State& state) {
  const SimulatedViews& views = million_sample_views(1);
  double triangles = 0;
  for (auto _ : state) {
    const Mesh mesh = triangulate_grid(*views.grids[0], views.flags[0]);
    triangles = static_cast<double>(mesh.faces.size());
    benchmark::DoNotOptimize(mesh.faces.data());
  }
  state.counters["triangles"] = triangles;
  report_rate(state, triangles, 41e6, "triangles/s; reference: trimesh2, 41 million a core");
}
BENCHMARK(triangulate_one_grid)->Unit(benchmark::kMillisecond)->UseRealTime();

void stitch_eleven(benchmark::State& state) {
  const SimulatedViews& views = million_sample_views(11);
  const JobContext job;
  const std::vector<PlacedScan> placed = views.placed();
  for (auto _ : state) {
    benchmark::DoNotOptimize(stitch(placed, {}, job));
  }
  report_rate(state, static_cast<double>(views.samples()), 500e3,
              "reference: 500 000 samples/s wanted (seed 001: about 17 000)");
}
BENCHMARK(stitch_eleven)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(2);

}  // namespace
}  // namespace dubsar::bench
