// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Screened Poisson reconstruction alone, on the Stanford bunny's ten range grids with their published poses:
// how far the input samples lie from the surface, beside what PoissonRecon 18.75 reached on the same input
// (depth 8, cells of 0.67 mm: mean 0.087, RMS 0.128, 95 % 0.256 mm; depth 9: 0.077, 0.118, 0.228; 5.6
// and 22.7 s of CPU).
//   dubsar-poisson FOLDER/bun.conf [cell mm [screening]]
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/cell_samples.h"
#include "analysis/multigrid.h"
#include "analysis/screened_poisson.h"
#include "analysis/surface_nets.h"
#include "analysis/vertex_geometry.h"
#include "bench/support/options.h"
#include "bench/support/pair_cases.h"
#include "core/mesh_query.h"
#include "core/parallel.h"
#include "core/stage_times.h"
#include "triangulation/grid_triangulation.h"

namespace {

using namespace dubsar;

struct Points {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> areas, weights;
};

/// All samples of all scans in the model frame, with the normals and areas of each scan's own mesh.
Points gather(const std::vector<bench::PublishedScan>& scans) {
  Points points;
  for (const auto& scan : scans) {
    const Mesh mesh = triangulate_grid(*scan.grid, {});
    const VertexGeometry geometry = make_vertex_geometry(mesh, make_vertex_graph(mesh));
    const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      points.positions.push_back((scan.model_from_scanner * mesh.positions[v].cast<double>()).cast<float>());
      points.normals.push_back(rotation * geometry.normal[v]);
      points.areas.push_back(geometry.area_mm2[v]);
      points.weights.push_back(1.0F);
    }
  }
  return points;
}

int run(const std::filesystem::path& conf, float cell_mm, float screening) {
  constexpr float kRoomMm = 12;
  const JobContext job;
  const Points points = gather(bench::read_published(conf.parent_path().string(), conf.string(), 1000.0));
  if (points.positions.empty()) {
    std::fprintf(stderr, "%s: no scans with poses\n", conf.c_str());
    return 2;
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points.positions) {
    box.extend(p);
  }
  const auto start = std::chrono::steady_clock::now();
  NodeGrid grid;
  grid.cell_mm = cell_mm;
  grid.origin_mm = box.min().array() - kRoomMm;
  const auto nodes = [&](float length) {
    return Multigrid::rounded_up(static_cast<int>((length + 2 * kRoomMm) / cell_mm) + 1);
  };
  grid.nx = nodes(box.sizes().x());
  grid.ny = nodes(box.sizes().y());
  grid.nz = nodes(box.sizes().z());
  const std::vector<CellSample> cells =
      gather_cell_samples(points.positions, points.normals, points.areas, points.weights, grid);
  // Ten scans overlap: as everywhere, what several of them saw is there once.
  std::vector<PoissonSample> samples;
  for (const CellSample& cell : cells) {
    const float once = std::min(1.0F, cell_mm * cell_mm / cell.area_mm2);
    samples.push_back({cell.position_mm, once * cell.area_normal_mm2, once * cell.area_mm2});
  }
  PoissonOptions options;
  options.screening = screening;
  const Indicator indicator = solve_screened_poisson(samples, grid, options, job);
  const Mesh surface = surface_nets(grid, indicator.value, 0.0F);
  const double seconds = seconds_since(start);
  const MeshQuery query(surface);
  std::vector<double> off(points.positions.size());
  parallel_for_each_index(off.size(), [&](std::size_t i) {
    const auto near = query.closest(points.positions[i], 10.0F);
    off[i] = near ? near->distance_mm : 10.0;
  });
  std::sort(off.begin(), off.end());
  double sum = 0;
  double squares = 0;
  for (const double d : off) {
    sum += d;
    squares += d * d;
  }
  const auto count = static_cast<double>(off.size());
  std::printf("%zu samples, %d x %d x %d nodes of %.2f mm, %d iterations, %zu faces, %.2f s\n", off.size(),
              grid.nx, grid.ny, grid.nz, static_cast<double>(cell_mm), indicator.iterations,
              surface.faces.size(), seconds);
  std::printf("sample to surface, mm: mean %.3f  RMS %.3f  95 %% %.3f\n", sum / count,
              std::sqrt(squares / count), off[static_cast<std::size_t>(0.95 * count)]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string conf;
  float cell_mm = 0.67F;
  float screening = PoissonOptions{}.screening;
  CLI::App app("Screened Poisson reconstruction of the Stanford bunny", "dubsar-poisson");
  app.add_option("conf", conf, "FOLDER/bun.conf")->required()->check(CLI::ExistingFile);
  app.add_option("cell", cell_mm, "mm")->check(CLI::Range(0.05F, 10.0F));
  app.add_option("screening", screening)->check(CLI::NonNegativeNumber);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  return run(conf, cell_mm, screening);
}
