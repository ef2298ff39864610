// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// One mesh from many scans, Dubsar's beside what other programs make of the same samples at the same poses.
//
//   dubsar-meshers tablet [--seed S --tablets N --spacing 0.05 --noise 0.02 --views 12 --width 23.3]
//   dubsar-meshers bunny FOLDER
//
// Vertices count within two µ of a sample: what a program adds where nothing was scanned is neither for nor
// against it. The peers that CMake found stand in the same table, and so does seed 001's own stitching
// (bench/support/link_stitch.h). Columns: non-manifold edges and vertices, faces that are turned
// against a neighbour, parts, boundary, pairs of faces that cut each other, faces with an angle below 10°.
#include "bench/accuracy/meshers.h"
#include "bench/support/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <variant>

#include "bench/support/link_stitch.h"
#include "bench/support/mesh_score.h"
#include "bench/support/pair_cases.h"
#include "bench/support/statistics.h"
#include "bench/support/surface_samples.h"
#include "bench/support/true_scans.h"
#include "core/parallel.h"
#include "core/stage_times.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;
using Eigen::Vector3f;

[[noreturn]] void die(const std::string& text) {
  std::fprintf(stderr, "dubsar-meshers: %s\n", text.c_str());
  std::exit(2);
}

struct Scans {
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<RigidTransform> poses;
  std::vector<SampleFlags> flags;
  ClearedMap map;
  MesherInput input;
  Mesh all;  ///< the triangles of all scans, unmerged: where something was sampled
};

std::unique_ptr<Scans> prepare(std::vector<std::shared_ptr<const RangeGrid>> grids,
                               std::vector<RigidTransform> poses, double spacing_mm) {
  auto out = std::make_unique<Scans>();
  out->grids = std::move(grids);
  out->poses = std::move(poses);
  out->flags.reserve(out->grids.size());
  out->input.spacing_mm = spacing_mm;
  for (std::size_t k = 0; k < out->grids.size(); ++k) {
    const RangeGrid& grid = *out->grids[k];
    const RigidTransform& pose = out->poses[k];
    out->flags.push_back(flag_sparse(grid));
    out->map.add({static_cast<int>(k), &grid, &out->flags.back(), pose, 0.0});
    Mesh mesh = triangulate_grid(grid, out->flags.back());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      mesh.positions[v] = (pose * mesh.positions[v].cast<double>()).cast<float>();
      mesh.normals[v] = pose.rotation.cast<float>() * mesh.normals[v];
    }
    const auto base = static_cast<std::uint32_t>(out->all.positions.size());
    out->all.positions.insert(out->all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const auto& f : mesh.faces) {
      out->all.faces.push_back({base + f[0], base + f[1], base + f[2]});
    }
    out->input.scans.push_back({&grid, pose, std::move(mesh)});
  }
  return out;
}

std::vector<Mesher> meshers(const Scans& scans, const std::vector<int>& poisson_depths) {
  std::vector<Mesher> out = {{"Dubsar", [&scans](const MesherInput&) {
                                JobContext job;
                                auto mesh = stitch(scans.map.scans(), {}, job);
                                if (!mesh) {
                                  die(mesh.error().line());
                                }
                                return std::optional(std::move(*mesh));
                              }}};
  for (const bool one_to_one : {false, true}) {
    out.push_back({one_to_one ? "the seed's links, pairs one to one" : "the seed's links",
                   [&scans, one_to_one](const MesherInput&) {
                     return std::optional(stitch_links(scans.map.scans(), {.one_to_one = one_to_one}));
                   }});
  }
#ifdef DUBSAR_HAS_OPEN3D
  for (Mesher& peer : open3d_meshers(poisson_depths)) {
    out.push_back(std::move(peer));
  }
#else
  (void)poisson_depths;
#endif
  for (Mesher& peer : vcg_meshers()) {
    out.push_back(std::move(peer));
  }
  return out;
}

void print_head(const char* truth_columns) {
  std::printf("  %-36s %8s %9s %9s %9s %9s %7s %9s %8s %7s   %s\n", "", "s", "faces", "nm edges", "nm verts",
              "turned", "parts", "open mm", "cut", "<10deg", truth_columns);
}

void print_mesh(const std::string& name, const Mesh& mesh, double took_s) {
  const MeshReport r = check_mesh(mesh);
  std::printf("  %-36s %8.2f %9zu %9zu %9zu %9zu %7zu %9.1f %8zu %6.2f%%", name.c_str(), took_s, r.faces,
              r.non_manifold_edges, r.non_manifold_vertices, r.inconsistent_faces, r.components,
              r.boundary_length_mm, r.self_intersections, 100 * r.thin_share);
}

/// Runs each of them and prints its row; score(mesh) ends it.
template <class Score>
void compare(const Scans& scans, const std::vector<int>& poisson_depths, const char* score_columns,
             const Score& score) {
  print_head(score_columns);
  for (const Mesher& mesher : meshers(scans, poisson_depths)) {
    const auto start = std::chrono::steady_clock::now();
    const std::optional<Mesh> mesh = mesher.run(scans.input);
    const double took_s = seconds_since(start);
    if (!mesh || mesh->faces.empty()) {
      std::printf("  %-36s could not be run\n", mesher.name.c_str());
      continue;
    }
    print_mesh(mesher.name, *mesh, took_s);
    score(*mesh);
    std::fflush(stdout);
  }
}

std::vector<std::uint8_t> within(const std::vector<Vector3f>& points, const MeshQuery& of, double mm) {
  std::vector<std::uint8_t> out(points.size());
  parallel_for_each_index(
      out.size(), [&](std::size_t i) { out[i] = of.closest(points[i], static_cast<float>(mm)) ? 1 : 0; });
  return out;
}

struct TabletArguments {
  std::uint64_t seed = 1;
  int tablets = 1;
  double spacing_mm = 0.05;
  double noise_mm = 0.02;
  int views = 12;
  double width_mm = 23.3;  ///< Poisson has cells of µ at depth 9
};

void tablet(const TabletArguments& args, std::uint64_t seed) {
  sim::TabletOptions options = random_tablet(seed, "text", 0.5 * args.spacing_mm);
  options.size_mm = {args.width_mm, 0.8 * args.width_mm, 0.4 * args.width_mm};
  JobContext job;
  const auto truth = sim::make_tablet(options, job);
  if (!truth) {
    die(truth.error().line());
  }
  TrueScanOptions scanning;
  scanning.spacing_mm = args.spacing_mm;
  scanning.noise_mm = args.noise_mm;
  scanning.views = args.views;
  scanning.seed = seed;
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<RigidTransform> poses;
  std::size_t samples = 0;
  for (const TrueScan& scan : true_scans(options, scanning)) {
    grids.push_back(scan.grid);
    poses.push_back(scan.tablet_from_scanner);
    samples += scan.grid->valid_count();
  }
  const auto scans = prepare(std::move(grids), std::move(poses), args.spacing_mm);
  const MeshQuery surface(truth->mesh);
  const MeshQuery sampled(scans->all);
  const double reach_mm = 2 * args.spacing_mm;
  const std::vector<std::uint8_t> truth_sampled = within(truth->mesh.positions, sampled, reach_mm);
  std::vector<std::uint8_t> truth_edge = near_wedge_edge(*truth, truth->mesh.positions);
  for (std::size_t i = 0; i < truth_edge.size(); ++i) {
    truth_edge[i] &= truth_sampled[i];
  }
  std::printf(
      "tablet %llu, %.0f x %.0f x %.0f mm, %zu scans, %.2f million samples, noise %.0f um, mu %.0f um\n",
      static_cast<unsigned long long>(seed), options.size_mm.x(), options.size_mm.y(), options.size_mm.z(),
      scans->grids.size(), 1e-6 * static_cast<double>(samples), 1e3 * args.noise_mm, 1e3 * args.spacing_mm);
  // Its cells are 1.1 times the longest side over 2^depth.
  const int depth = static_cast<int>(std::lround(std::log2(1.1 * args.width_mm / args.spacing_mm)));
  const char* columns =
      "um RMS: vertices, at wedge edges; surface to mesh, at wedge edges; 99 %; within 50 um";
  compare(*scans, {depth}, columns, [&](const Mesh& mesh) {
    const std::vector<std::uint8_t> counts = within(mesh.positions, sampled, reach_mm);
    std::vector<std::uint8_t> at_edge = near_wedge_edge(*truth, mesh.positions);
    for (std::size_t i = 0; i < at_edge.size(); ++i) {
      at_edge[i] &= counts[i];
    }
    const std::vector<double> error = distances_mm(mesh.positions, surface, 1.0);
    const MeshQuery model(mesh);
    const std::vector<double> to_model = distances_mm(truth->mesh.positions, model, 1.0);
    const std::vector<double> held = chosen(to_model, truth_sampled);
    std::printf("   %6.2f %6.2f; %6.2f %6.2f; %6.1f; %7.3f %%\n", 1e3 * rms(chosen(error, counts)),
                1e3 * rms(chosen(error, at_edge)), 1e3 * rms(held), 1e3 * rms(chosen(to_model, truth_edge)),
                1e3 * quantile(held, 0.99), 100 * share_within(held, 0.05));
  });
}

void bunny(const std::string& folder) {
  const std::vector<PublishedScan> published = read_published(folder, folder + "/bun.conf", 1000.0);
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<RigidTransform> poses;
  std::vector<Vector3f> samples;
  std::vector<std::uint8_t> of_peers;
  for (const PublishedScan& scan : published) {
    grids.push_back(scan.grid);
    poses.push_back(scan.model_from_scanner);
    const std::vector<std::uint8_t> of_grid = surface_samples(*scan.grid, kPeersLongestSideMm);
    of_peers.insert(of_peers.end(), of_grid.begin(), of_grid.end());
    for (std::size_t i = 0; i < scan.grid->size(); ++i) {
      if (scan.grid->valid[i] != 0) {
        samples.push_back((scan.model_from_scanner * scan.grid->point(i).cast<double>()).cast<float>());
      }
    }
  }
  // Rows of these grids lie 0.5 mm apart, as the peers' published figures take it.
  const auto scans = prepare(std::move(grids), std::move(poses), 0.5);
  std::printf("bunny: %zu scans, %zu samples\n", scans->grids.size(), samples.size());
  compare(*scans, {8, 9}, "mm from the samples to the mesh: mean, RMS, 95 %; of those that count for peers",
          [&](const Mesh& mesh) {
            const MeshQuery model(mesh);
            const std::vector<double> d = distances_mm(samples, model, 10.0);
            const std::vector<double> p = chosen(d, of_peers);
            std::printf("   %.4f %.4f %.4f; %.4f %.4f %.4f\n", mean(d), rms(d), quantile(d, 0.95), mean(p),
                        rms(p), quantile(p, 0.95));
          });
}

}  // namespace

int main(int argc, char** argv) {
  TabletArguments args;
  std::string folder;
  CLI::App app("one mesh from many scans, beside other programs");
  app.require_subcommand(1);
  auto* sim = app.add_subcommand("tablet");
  sim->add_option("--seed", args.seed);
  sim->add_option("--tablets", args.tablets);
  sim->add_option("--spacing", args.spacing_mm);
  sim->add_option("--noise", args.noise_mm);
  sim->add_option("--views", args.views);
  sim->add_option("--width", args.width_mm);
  auto* real = app.add_subcommand("bunny");
  real->add_option("folder", folder)->required()->check(CLI::ExistingDirectory);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  if (real->parsed()) {
    bunny(folder);
    return 0;
  }
  for (int k = 0; k < args.tablets; ++k) {
    tablet(args, args.seed + static_cast<std::uint64_t>(k));
  }
  return 0;
}
