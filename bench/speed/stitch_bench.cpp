// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <vector>

#include "core/placed_scan.h"
#include "core/random.h"
#include "core/units.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

/// A pillow 50 × 40 × 20 mm, an ellipsoid with exponents of 4 across and 2 in thickness, and a wavy surface.
double pillow(const Eigen::Vector3d& p) {
  return std::pow(p.x() / 25, 4) + std::pow(p.y() / 20, 4) + std::pow(p.z() / 10, 2) +
         0.02 * std::sin(2 * p.x()) * std::sin(2 * p.y()) - 1;
}

/// The pillow as an orthographic scanner sees it; rays are walked to the first change of sign.
RangeGrid scan_pillow(const RigidTransform& model_from_scanner, double spacing_mm, std::uint64_t seed) {
  RangeGrid grid;
  const int side = static_cast<int>(60 / spacing_mm);
  grid.allocate(side, side);
  grid.spacing_mm = spacing_mm;
  Random random(seed);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double x = (col - side / 2) * spacing_mm;
      const double y = (row - side / 2) * spacing_mm;
      const auto value = [&](double z) { return pillow(model_from_scanner * Eigen::Vector3d(x, y, z)); };
      double above = 32;
      double below = above;
      while (below > -32 && value(below) > 0) {
        above = below;
        below -= 0.5;
      }
      if (below <= -32) {
        continue;
      }
      for (int k = 0; k < 16; ++k) {
        const double middle = 0.5 * (above + below);
        (value(middle) > 0 ? above : below) = middle;
      }
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(above + 0.02 * random.normal());
      grid.valid[i] = 1;
    }
  }
  return grid;
}

struct Scene {
  std::deque<RangeGrid> grids;
  std::vector<PlacedScan> placed;
  std::size_t samples = 0;

  Scene(int views, double spacing_mm) {
    for (int k = 0; k < views; ++k) {
      const double z = 1 - 2 * (k + 0.5) / views;
      const double r = std::sqrt(1 - z * z);
      const double phi = k * kPi * (3 - std::sqrt(5.0));
      const Eigen::Vector3d out(r * std::cos(phi), r * std::sin(phi), z);
      RigidTransform pose;
      pose.rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out).toRotationMatrix();
      grids.push_back(scan_pillow(pose, spacing_mm, static_cast<std::uint64_t>(k)));
      placed.push_back({k, &grids.back(), nullptr, pose, 0.02});
      samples += grids.back().valid_count();
    }
  }
};

void BM_TriangulateGrid(benchmark::State& state) {
  const Scene scene(1, 60.0 / static_cast<double>(state.range(0)));
  std::size_t faces = 0;
  for (auto _ : state) {
    const Mesh mesh = triangulate_grid(scene.grids[0], {});
    faces += mesh.faces.size();
    benchmark::DoNotOptimize(mesh.faces.data());
  }
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(faces), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_TriangulateGrid)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Stitch(benchmark::State& state) {
  const Scene scene(12, static_cast<double>(state.range(0)) * 1e-3);
  std::size_t done = 0;
  for (auto _ : state) {
    JobContext job;
    const Result<Mesh> mesh = stitch(scene.placed, {}, job);
    if (!mesh) {
      state.SkipWithError(mesh.error().line().c_str());
      break;
    }
    done += scene.samples;
  }
  state.counters["samples"] = static_cast<double>(scene.samples);
  state.counters["samples/s"] = benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_Stitch)->Arg(200)->Arg(100)->Arg(70)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace dubsar

BENCHMARK_MAIN();
