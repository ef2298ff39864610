// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Seconds by stage of the surface fields on simulated tablets as large as the three that the published chain
// was timed on (seed 000, Fig. 10: Core i7-2600 with 4 cores, GeForce GTX 560 Ti), beside its times and those
// of other programs, and the peak of memory.
//   dubsar-field-speed [0|1|2 …]   which of the three; all without

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "analysis/integral_invariants.h"
#include "analysis/surface_fields.h"
#include "bench/support/options.h"
#include "bench/support/peak_memory.h"
#include "bench/support/statistics.h"
#include "core/stage_times.h"
#include "sim/tablet.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Case {
  const char* like;
  Eigen::Vector3d size_mm;
  double spacing_mm;
  std::map<std::string, double> published_s;
};

const Case kCases[] = {{"Bo 2743, 3 193 251 faces",
                        {60, 50, 25},
                        0.07372,
                        {{"curvature", 1.2}, {"openness", 2.0}, {"poisson", 24.8}, {"height", 22.3}}},
                       {"Bo 71/222, 6 741 778 faces",
                        {80, 60, 28},
                        0.06307,
                        {{"curvature", 2.4}, {"openness", 4.8}, {"poisson", 35.5}, {"height", 61.4}}},
                       {"310/b, 13 784 923 faces",
                        {110, 80, 30},
                        0.05749,
                        {{"curvature", 4.9}, {"openness", 8.8}, {"poisson", 41.9}, {"height", 121.5}}}};

int time_case(const Case& c) {
  JobContext job;
  sim::TabletOptions options;
  options.seed = 5;
  options.size_mm = c.size_mm;
  options.spacing_mm = c.spacing_mm;
  auto tablet = sim::make_tablet(options, job);
  if (!tablet) {
    std::fprintf(stderr, "%s\n", tablet.error().line().c_str());
    return 2;
  }
  Mesh mesh;
  mesh.positions = std::move(tablet->mesh.positions);
  mesh.faces = std::move(tablet->mesh.faces);
  *tablet = {};
  std::printf("\n%zu vertices, %zu faces (like %s), %d threads\n%-22s %8s %14s\n", mesh.positions.size(),
              mesh.faces.size(), c.like, tbb::info::default_concurrency(), "stage", "s", "published s");
  StageTimes times;
  auto start = std::chrono::steady_clock::now();
  const VertexGraph graph = make_vertex_graph(mesh);
  times.emplace_back("graph", seconds_since(start));
  const auto fields = compute_surface_fields(mesh, graph, {}, job, &times);
  if (!fields) {
    std::fprintf(stderr, "%s\n", fields.error().line().c_str());
    return 2;
  }
  double all = 0;
  double published = 0;
  for (const auto& [stage, s] : times) {
    all += s;
    const auto known = c.published_s.find(stage);
    if (known == c.published_s.end()) {
      std::printf("%-22s %8.2f\n", stage.c_str(), s);
    } else {
      published += known->second;
      std::printf("%-22s %8.2f %14.1f\n", stage.c_str(), s, known->second);
    }
  }
  std::printf("%-22s %8.2f %14.1f   %.1f times as fast; peak so far %.2f GiB\n", "together", all, published,
              published / all, peak_gib());
  start = std::chrono::steady_clock::now();
  const IntegralInvariants invariants =
      integral_invariants(mesh, outlook_of(mesh, *fields), fields->mean_edge_mm, {}, job);
  std::printf("%-22s %8.2f %14s   GigaMesh, a tablet on average; peak so far %.2f GiB\n",
              "integral invariants", seconds_since(start), "68 min", peak_gib());
  return invariants.value.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> wanted;
  CLI::App app("Seconds by stage of the surface fields", "dubsar-field-speed");
  app.add_option("case", wanted, "which of the three; all without")
      ->check(CLI::Range(0, static_cast<int>(std::size(kCases)) - 1));
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  std::printf(
      "Other programs at 6.9 million vertices, one core: curvature 2.66 s (trimesh2), ambient occlusion "
      "125.7 s (Embree, 64 rays).\nPoisson reconstruction of depth 8 at 1.6 million: 6.5 s (PoissonRecon); "
      "closest points 2.6 us each (Embree).\n");
  int status = 0;
  for (int i = 0; i < static_cast<int>(std::size(kCases)); ++i) {
    if (wanted.empty() || std::ranges::find(wanted, i) != wanted.end()) {
      status = std::max(status, time_case(kCases[i]));
    }
  }
  return status;
}
