// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
//   dubsar-sigmas [--seed S --tablets N --spacing 0.05 ... --noise 0.02 ... --views 12 --width 13]
//                 [--pose-error 0 --poses-trusted | --registered] [--other-spacing 0]
//     simulated scans, true poses, poses that are off independently of each other or as registration finds
//     them, in the frame of the scan that it holds: error of the mesh's vertices over their own sigma, RMS
//     (none counts as more than 10) and the quantiles of 68.3 and 95.4 % (1 and 2 of a normal distribution),
//     by what a vertex is: of one scan, by its incidence; of several; interpolated; within 0.2 mm of wedge
//     edges or not
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/support/mesh_score.h"
#include "bench/support/options.h"
#include "bench/support/registered_poses.h"
#include "bench/support/statistics.h"
#include "bench/support/true_scans.h"
#include "core/mesh_query.h"
#include "core/random.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  std::uint64_t seed = 1;
  int tablets = 1;
  std::vector<double> spacings_mm = {0.05};
  std::vector<double> noises_mm = {0.02};
  int views = 12;
  double width_mm = 13;
  double pose_error_mm = 0;
  bool poses_trusted = false;
  bool registered = false;
  double other_spacing_mm = 0;
};

/// What is known of the vertices of one kind.
struct Kind {
  std::vector<double> ratios;  ///< error / sigma
  std::vector<double> errors_mm;
  std::vector<double> sigmas_mm;
};

std::string kind_of(const Mesh& mesh, std::size_t v) {
  if ((mesh.flags[v] & kVertexInterpolated) != 0) {
    return "interpolated";
  }
  std::string rest = (mesh.flags[v] & kVertexSparse) != 0 ? ", sparse" : "";
  if ((mesh.flags[v] & kVertexBoundary) != 0) {
    rest += ", boundary";
  }
  if (mesh.scans[v] > 1) {
    return (mesh.scans[v] < 4 ? "2-3 scans" : "4 and more scans") + rest;
  }
  return (mesh.reliability[v] > 0.5F    ? "1 scan, below 45 deg"
          : mesh.reliability[v] > 0.12F ? "1 scan, below 70 deg"
                                        : "1 scan, grazing") +
         rest;
}

void measure(const Arguments& args, std::uint64_t seed, double spacing_mm, double noise_mm,
             std::map<std::string, Kind>& kinds) {
  sim::TabletOptions options = random_tablet(seed, "text", 0.5 * std::min(spacing_mm, 0.1));
  options.size_mm = {args.width_mm, 0.8 * args.width_mm, 0.4 * args.width_mm};
  JobContext job;
  const auto truth = sim::make_tablet(options, job);
  if (!truth) {
    std::fprintf(stderr, "%s\n", truth.error().line().c_str());
    std::exit(2);
  }
  TrueScanOptions scanning;
  scanning.spacing_mm = spacing_mm;
  scanning.noise_mm = noise_mm;
  scanning.views = args.views;
  scanning.seed = seed;
  std::vector<TrueScan> scans;
  if (args.other_spacing_mm > 0) {
    for (const std::size_t odd : {0U, 1U}) {
      scanning.spacing_mm = odd == 0 ? spacing_mm : args.other_spacing_mm;
      scanning.only.clear();
      for (std::size_t v = odd; v < static_cast<std::size_t>(args.views); v += 2) {
        scanning.only.push_back(v);
      }
      std::ranges::move(true_scans(options, scanning), std::back_inserter(scans));
    }
  } else {
    scans = true_scans(options, scanning);
  }
  Random random(seed_for(seed, 77));
  const std::vector<ScanPose> found = args.registered ? registered_poses(scans) : std::vector<ScanPose>{};
  RigidTransform tablet_from_model;
  for (const ScanPose& pose : found) {
    const auto k = static_cast<std::size_t>(pose.id);
    if (pose.status == PoseStatus::kRegistered && pose.sigma_mm == 0) {
      tablet_from_model = scans[k].tablet_from_scanner * pose.model_from_scanner.inverse();
      break;
    }
  }
  std::vector<SampleFlags> flags(scans.size());
  ClearedMap map;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    RigidTransform pose = scans[k].tablet_from_scanner;
    pose.translation_mm += args.pose_error_mm * random.normal3().normalized();
    double sigma_mm = args.pose_error_mm;
    if (args.registered) {
      if (found[k].status != PoseStatus::kRegistered) {
        continue;
      }
      pose = tablet_from_model * found[k].model_from_scanner;
      sigma_mm = found[k].sigma_mm;
    }
    flags[k] = flag_sparse(*scans[k].grid);
    map.add({static_cast<int>(k), scans[k].grid.get(), &flags[k], pose, args.poses_trusted ? 0.0 : sigma_mm});
  }
  double estimated_um = 0;
  for (const PlacedScan& scan : map.scans()) {
    estimated_um += 1e3 * *scan.noise_mm / static_cast<double>(scans.size());
  }
  std::printf("seed %llu: noise estimated from the scans: %.2f um\n", static_cast<unsigned long long>(seed),
              estimated_um);
  const auto mesh = stitch(map.scans(), {}, job);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().line().c_str());
    std::exit(2);
  }
  const MeshQuery surface(truth->mesh);
  const std::vector<double> error_mm = distances_mm(mesh->positions, surface, 1.0);
  const std::vector<std::uint8_t> at_edge = near_wedge_edge(*truth, mesh->positions);
  for (std::size_t v = 0; v < error_mm.size(); ++v) {
    const double sigma_mm = std::max(1e-9, static_cast<double>(mesh->sigma_mm[v]));
    const double ratio = std::min(error_mm[v] / sigma_mm, 10.0);
    for (const std::string& name :
         {std::string("all"), kind_of(*mesh, v) + (at_edge[v] != 0 ? " / edge" : "")}) {
      Kind& kind = kinds[name];
      kind.ratios.push_back(ratio);
      kind.errors_mm.push_back(error_mm[v]);
      kind.sigmas_mm.push_back(sigma_mm);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments args;
  CLI::App app("whether the sigmas of the stitched mesh's vertices are true");
  app.add_option("--seed", args.seed);
  app.add_option("--tablets", args.tablets);
  app.add_option("--spacing", args.spacings_mm);
  app.add_option("--noise", args.noises_mm);
  app.add_option("--views", args.views);
  app.add_option("--width", args.width_mm);
  app.add_option("--pose-error", args.pose_error_mm);
  app.add_flag("--poses-trusted", args.poses_trusted, "as if the poses had no error");
  app.add_flag("--registered", args.registered, "poses and their errors as registration has them")
      ->excludes("--pose-error");
  app.add_option("--other-spacing", args.other_spacing_mm, "of every other scan");
  if (const auto status = ends_with(app, argc, argv)) {
    return *status;
  }
  for (const double spacing_mm : args.spacings_mm) {
    for (const double noise_mm : args.noises_mm) {
      std::map<std::string, Kind> kinds;
      for (int k = 0; k < args.tablets; ++k) {
        measure(args, args.seed + static_cast<std::uint64_t>(k), spacing_mm, noise_mm, kinds);
      }
      std::printf("spacing %.3f mm, noise %.1f um\n", spacing_mm, 1e3 * noise_mm);
      std::printf("  %-36s %9s %6s %6s %6s %10s %10s\n", "", "vertices", "RMS", "68.3%", "95.4%", "error um",
                  "sigma um");
      for (const auto& [name, kind] : kinds) {
        std::printf("  %-36s %9zu %6.2f %6.2f %6.2f %10.1f %10.1f\n", name.c_str(), kind.ratios.size(),
                    rms(kind.ratios), quantile(kind.ratios, 0.683), quantile(kind.ratios, 0.954),
                    1e3 * rms(kind.errors_mm), 1e3 * rms(kind.sigmas_mm));
      }
      std::fflush(stdout);
    }
  }
  return 0;
}
