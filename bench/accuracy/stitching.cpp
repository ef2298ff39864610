// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
//   dubsar-stitching tablet [--seed S --spacing 0.05 --noise 0.02 --views 12 --pose-error 0 --scans-off 12
//   --tablets N]
//     simulated scans, true poses or (the first so many) off by a shift of that length: how far the mesh's
//     vertices lie from the true surface, everywhere and at wedge edges; how much of the surface it holds;
//     whether its uncertainties are true; how crumpled it is; its topology
//   dubsar-stitching bunny FOLDER
//     published scans with their published poses (the .conf of the folder), the bunny or any other: input
//     sample to mesh and what perfect averaging would leave, topology, shape, time; boundary beside that of
//     reconstruction/bun_zipper.ply
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "bench/support/averaging_floor.h"
#include "bench/support/mesh_score.h"
#include "bench/support/options.h"
#include "bench/support/statistics.h"
#include "bench/support/surface_samples.h"
#include "bench/support/true_scans.h"
#include "core/mesh_query.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/stage_times.h"
#include "core/units.h"
#include "formats/grid_reader.h"
#include "formats/mesh_io.h"
#include "formats/poses_conf.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;
using Eigen::Vector3f;

struct Arguments {
  std::uint64_t seed = 1;
  int tablets = 1;
  double spacing_mm = 0.05;
  double noise_mm = 0.02;
  int views = 12;
  double pose_error_mm = 0;
  int scans_off = 1 << 20;
  double width_mm = 0;
  std::string folder;
  std::string out;
};

[[noreturn]] void die(const std::string& text) {
  std::fprintf(stderr, "dubsar-stitching: %s\n", text.c_str());
  std::exit(2);
}

/// Open edges (head to tail along the faces), as a map from each vertex to the next along the boundary.
std::map<std::uint32_t, std::uint32_t> boundary_of(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> half_edges;
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      half_edges.insert({f[k], f[(k + 1) % 3]});
    }
  }
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [a, b] : half_edges) {
    if (!half_edges.contains({b, a})) {
      next[b] = a;
    }
  }
  return next;
}

/// The boundary loops of a mesh, and how much of them lies where the reference has none (farther than
/// away_mm from its boundary).
void print_boundary(const Mesh& mesh, const Mesh& reference, double away_mm) {
  const auto next = boundary_of(mesh);
  std::vector<Vector3f> edge_of_reference;
  for (const auto& [a, b] : boundary_of(reference)) {
    edge_of_reference.push_back(reference.positions[a]);
  }
  double all_mm = 0, away_sum_mm = 0;
  std::set<std::uint32_t> seen;
  for (const auto& [start, unused] : next) {
    double length_mm = 0, away_length_mm = 0;
    std::size_t count = 0;
    Vector3f at_away = Vector3f::Zero();
    for (std::uint32_t v = start; seen.insert(v).second && next.contains(v); v = next.at(v)) {
      const Vector3f& p = mesh.positions[v];
      const double edge_mm = (mesh.positions[next.at(v)] - p).norm();
      double nearest = 1e9;
      for (const Vector3f& q : edge_of_reference) {
        nearest = std::min(nearest, static_cast<double>((p - q).squaredNorm()));
      }
      length_mm += edge_mm;
      if (nearest > away_mm * away_mm) {
        away_length_mm += edge_mm;
        at_away = p;
      }
      ++count;
    }
    if (count > 0) {
      std::printf(
          "    loop of %zu edges, %.1f mm, %.1f mm of it where the reference is closed (%.0f %.0f %.0f)\n",
          count, length_mm, away_length_mm, at_away.x(), at_away.y(), at_away.z());
      all_mm += length_mm;
      away_sum_mm += away_length_mm;
    }
  }
  std::printf("  boundary %.1f mm, %.1f mm of it where the reference is closed\n", all_mm, away_sum_mm);
}

/// Between faces that share an edge, degrees.
std::vector<double> folds_deg(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vector3f> normal_beyond;
  std::vector<double> folds;
  for (const auto& f : mesh.faces) {
    const Vector3f& a = mesh.positions[f[0]];
    const Vector3f n = (mesh.positions[f[1]] - a).cross(mesh.positions[f[2]] - a).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = f[k], to = f[(k + 1) % 3];
      if (const auto found = normal_beyond.find({to, from}); found != normal_beyond.end()) {
        const double cosine = std::clamp(static_cast<double>(n.dot(found->second)), -1.0, 1.0);
        folds.push_back(deg_from_rad(std::acos(cosine)));
      } else {
        normal_beyond[{from, to}] = n;
      }
    }
  }
  return folds;
}

std::vector<PlacedScan> cleared(const std::vector<std::shared_ptr<const RangeGrid>>& grids,
                                const std::vector<RigidTransform>& poses, double sigma_mm,
                                std::vector<SampleFlags>& flags, ClearedMap& map) {
  flags.clear();
  flags.reserve(grids.size());
  for (std::size_t k = 0; k < grids.size(); ++k) {
    flags.push_back(flag_sparse(*grids[k]));
    map.add({static_cast<int>(k), grids[k].get(), &flags[k], poses[k], sigma_mm});
  }
  return map.scans();
}

int tablet(const Arguments& args, std::uint64_t seed) {
  sim::TabletOptions options = random_tablet(seed, "text", 0.5 * args.spacing_mm);
  if (args.width_mm > 0) {
    options.size_mm = {args.width_mm, 0.8 * args.width_mm, 0.4 * args.width_mm};
  }
  JobContext job;
  auto truth = sim::make_tablet(options, job);
  if (!truth) {
    die(truth.error().line());
  }
  const MeshQuery surface(truth->mesh);
  TrueScanOptions scanning;
  scanning.spacing_mm = args.spacing_mm;
  scanning.noise_mm = args.noise_mm;
  scanning.views = args.views;
  scanning.seed = seed;
  const std::vector<TrueScan> scans = true_scans(options, scanning);
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<RigidTransform> poses;
  Random random(seed_for(seed, 77));
  std::size_t samples = 0;
  for (const TrueScan& scan : scans) {
    grids.push_back(scan.grid);
    RigidTransform pose = scan.tablet_from_scanner;
    if (args.pose_error_mm > 0 && static_cast<int>(poses.size()) < args.scans_off) {
      const Eigen::Vector3d shift = random.normal3();
      pose.translation_mm += args.pose_error_mm * shift.normalized();
    }
    poses.push_back(pose);
    samples += scan.grid->valid_count();
  }
  std::vector<SampleFlags> flags;
  ClearedMap map;
  const std::vector<PlacedScan> placed = cleared(grids, poses, args.pose_error_mm, flags, map);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start_s = cpu_seconds();
  const auto mesh = stitch(placed, {}, job);
  const double took_s = seconds_since(start);
  const double cpu_s = cpu_seconds() - cpu_start_s;
  if (!mesh) {
    die(mesh.error().line());
  }
  if (!args.out.empty()) {
    if (const Status written = write_mesh(args.out, *mesh); !written) {
      die(written.error().line());
    }
  }
  std::printf(
      "%llu: %.0fx%.0fx%.0f, %zu scans, %.2f million samples, %.2f s (%.2f of processors), %.2f million "
      "samples/s\n",
      static_cast<unsigned long long>(seed), options.size_mm.x(), options.size_mm.y(), options.size_mm.z(),
      scans.size(), 1e-6 * static_cast<double>(samples), took_s, cpu_s,
      1e-6 * static_cast<double>(samples) / took_s);
  print_topology(*mesh);

  const std::vector<double> error = distances_mm(mesh->positions, surface, 1.0);
  const std::vector<std::uint8_t> at_edge = near_wedge_edge(*truth, mesh->positions);
  std::vector<double> measured, edges, interpolated;
  std::vector<double> by_scans[5];
  for (std::size_t i = 0; i < error.size(); ++i) {
    if ((mesh->flags[i] & kVertexInterpolated) != 0) {
      interpolated.push_back(error[i]);
      continue;
    }
    measured.push_back(error[i]);
    by_scans[std::min<int>(mesh->scans[i], 5) - 1].push_back(error[i]);
    if (at_edge[i] != 0) {
      edges.push_back(error[i]);
    }
  }
  std::printf(
      "  vertex error: RMS %.2f um, 95 %% %.2f; at wedge edges %.2f um RMS (%zu); interpolated %.1f um "
      "(%zu)\n",
      1e3 * rms(measured), 1e3 * quantile(measured, 0.95), 1e3 * rms(edges), edges.size(),
      1e3 * rms(interpolated), interpolated.size());
  std::printf("  by supporting scans:");
  for (int k = 0; k < 5; ++k) {
    std::printf(" %d: %.1f um (%zu)", k + 1, 1e3 * rms(by_scans[k]), by_scans[k].size());
  }
  double z2 = 0;
  std::size_t within1 = 0, within2 = 0, within3 = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double z = error[i] / std::max(1e-9, static_cast<double>(mesh->sigma_mm[i]));
    z2 += std::min(z * z, 100.0);
    within1 += z <= 1 ? 1 : 0;
    within2 += z <= 2 ? 1 : 0;
    within3 += z <= 3 ? 1 : 0;
  }
  const auto count = static_cast<double>(error.size());
  std::printf(
      "\n  error against its own sigma: mean square %.2f; within 1, 2, 3 sigma %.1f, %.1f, %.1f %%; "
      "reliability mean %.3f",
      z2 / count, 100 * static_cast<double>(within1) / count, 100 * static_cast<double>(within2) / count,
      100 * static_cast<double>(within3) / count,
      std::accumulate(mesh->reliability.begin(), mesh->reliability.end(), 0.0) / count);
  const std::vector<double> folds = folds_deg(*mesh);
  std::printf("\n  folds between faces: RMS %.2f degrees, beyond 60 %.2f %%", rms(folds),
              100 * (1 - share_within(folds, 60)));
  const MeshQuery model(*mesh);
  // The vertices of the true mesh are spread evenly over the surface.
  const std::vector<double> to_model = distances_mm(truth->mesh.positions, model, 1.0);
  std::vector<Vector3f> sampled;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    for (std::size_t i = 0; i < grids[s]->size(); ++i) {
      if (grids[s]->valid[i] != 0 && is_unflagged(flags[s][i])) {
        sampled.push_back((poses[s] * grids[s]->point(i).cast<double>()).cast<float>());
      }
    }
  }
  const std::vector<double> of_samples = distances_mm(sampled, model, 1.0);
  std::printf(
      "\n  surface within 50 um %.3f %%, 100 um %.3f %%; samples within 100 um %.3f %%, RMS %.1f um\n",
      100 * share_within(to_model, 0.05), 100 * share_within(to_model, 0.1),
      100 * share_within(of_samples, 0.1), 1e3 * rms(of_samples));
  return 0;
}

int bunny(const Arguments& args) {
  namespace fs = std::filesystem;
  const fs::path folder = args.folder;
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<RigidTransform> poses;
  std::vector<Vector3f> samples;
  std::vector<std::uint8_t> of_peers;
  fs::path conf;
  for (const auto& entry : fs::directory_iterator(folder)) {
    conf = entry.path().extension() == ".conf" ? entry.path() : conf;
  }
  Result<std::vector<ScanPose>> published = read_conf_poses(conf, 1000.0);
  if (!published) {
    die(published.error().line());
  }
  std::ranges::sort(*published, {}, &ScanPose::file);
  for (const ScanPose& scan : *published) {
    const std::string& file = scan.file;
    const RigidTransform& pose = scan.model_from_scanner;
    if (!fs::exists(folder / file)) {
      continue;
    }
    auto data = read_scan_file(folder / file, {.mm_per_unit = 1000.0});
    if (!data || !std::holds_alternative<RangeGrid>(data->front())) {
      die(file + " is no range grid");
    }
    auto grid = std::make_shared<const RangeGrid>(std::get<RangeGrid>(std::move(data->front())));
    for (std::size_t i = 0; i < grid->size(); ++i) {
      if (grid->valid[i] != 0) {
        samples.push_back((pose * grid->point(i).cast<double>()).cast<float>());
      }
    }
    const std::vector<std::uint8_t> of_grid = surface_samples(*grid, kPeersLongestSideMm);
    of_peers.insert(of_peers.end(), of_grid.begin(), of_grid.end());
    grids.push_back(std::move(grid));
    poses.push_back(pose);
  }
  const auto print_distances = [&](const std::string& of, const std::vector<double>& all) {
    const std::vector<double> p = chosen(all, of_peers);
    std::printf("  %s: mean %.4f, RMS %.4f, 95 %% %.4f mm; the %zu that count for peers: %.4f, %.4f, %.4f\n",
                of.c_str(), mean(all), rms(all), quantile(all, 0.95), p.size(), mean(p), rms(p),
                quantile(p, 0.95));
  };
  std::vector<SampleFlags> flags;
  ClearedMap map;
  const std::vector<PlacedScan> placed = cleared(grids, poses, 0.0, flags, map);
  JobContext job;
  double best_s = 1e9;
  double best_cpu_s = 1e9;
  Mesh mesh;
  for (int k = 0; k < 3; ++k) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start_s = cpu_seconds();
    auto result = stitch(placed, {}, job);
    best_s = std::min(best_s, seconds_since(start));
    best_cpu_s = std::min(best_cpu_s, cpu_seconds() - cpu_start_s);
    if (!result) {
      die(result.error().line());
    }
    mesh = std::move(*result);
  }
  if (!args.out.empty()) {
    if (const Status written = write_mesh(args.out, mesh); !written) {
      die(written.error().line());
    }
  }
  std::printf("%s: %zu scans, %zu samples, %.3f s, %.3f of processors (best of 3)\n", conf.stem().c_str(),
              grids.size(), samples.size(), best_s, best_cpu_s);
  print_topology(mesh);
  const MeshQuery model(mesh);
  std::vector<double> d = distances_mm(samples, model, 10.0);
  std::vector<double> good, bordering, sparse;
  std::size_t at = 0;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    for (std::size_t i = 0; i < grids[k]->size(); ++i) {
      if (grids[k]->valid[i] != 0) {
        const std::uint8_t flag = flags[k][i];
        ((flag & kSparse) != 0              ? sparse
         : (flag & kPotentiallySparse) != 0 ? bordering
                                            : good)
            .push_back(d[at++]);
      }
    }
  }
  for (const auto& [name, part] : {std::pair<const char*, std::vector<double>*>{"well sampled", &good},
                                   {"potentially sparse", &bordering},
                                   {"sparse", &sparse}}) {
    std::printf("    %s %zu: mean %.4f, RMS %.4f, 95 %% %.4f mm\n", name, part->size(), mean(*part),
                rms(*part), quantile(*part, 0.95));
  }
  print_distances("sample to mesh", d);
  for (const double reach_mm : {0.4, 1.5}) {
    const AveragingFloor floor = averaging_floor(grids, poses, flags, reach_mm);
    print_distances(fmt::format("  perfect averaging of what lies within {:.1f} mm would leave", reach_mm),
                    floor.residual_mm);
  }
  if (const auto zipper = read_mesh(folder / "reconstruction" / "bun_zipper.ply", {.mm_per_unit = 1000.0})) {
    print_topology(*zipper);
    print_boundary(mesh, *zipper, 3.0);
    const MeshQuery to_zipper(*zipper);
    print_distances("sample to bun_zipper", distances_mm(samples, to_zipper, 10.0));
    const std::vector<double> held = distances_mm(zipper->positions, model, 5.0);
    std::printf("  bun_zipper's vertices within 0.4 mm of the mesh: %.3f %%\n",
                100 * share_within(held, 0.4));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments args;
  CLI::App app("the stitched mesh against the truth");
  app.require_subcommand(1);
  auto* sim = app.add_subcommand("tablet");
  sim->add_option("--seed", args.seed);
  sim->add_option("--tablets", args.tablets);
  sim->add_option("--spacing", args.spacing_mm);
  sim->add_option("--noise", args.noise_mm);
  sim->add_option("--views", args.views);
  sim->add_option("--width", args.width_mm);
  sim->add_option("--pose-error", args.pose_error_mm);
  sim->add_option("--scans-off", args.scans_off);
  sim->add_option("-o", args.out);
  auto* real = app.add_subcommand("bunny");
  real->add_option("folder", args.folder)->required()->check(CLI::ExistingDirectory);
  real->add_option("-o", args.out);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  if (real->parsed()) {
    return bunny(args);
  }
  for (int k = 0; k < args.tablets; ++k) {
    tablet(args, args.seed + static_cast<std::uint64_t>(k));
  }
  return 0;
}
