// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
//   dubsar-odd-scans [--cases 1000 --seed 1 --only CASE --lost 0.01 -o FOLDER]
//
// Stitches small sets of scans that no tablet gives: folded, thin and touching bodies, exact coincidences,
// stray samples, holes, poses that are wrong, spacings that differ. Whatever the scans, the mesh has to be an
// oriented 2-manifold without faces that cut each other or vertices in one place, and the same one whatever
// the order of the scans and whatever came and went in between.
// With --lost also the cases of which more than this share of the samples is lost: taken where the body is,
// with good neighbours, and farther than the spacing from the mesh.
// Prints the cases that are not, ends with status 1 when there is one, and writes their scans and meshes to
// FOLDER; with --only those of that case, whatever it is.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "bench/support/odd_body.h"
#include "bench/support/options.h"
#include "core/mesh_query.h"
#include "core/placed_scan.h"
#include "formats/grid_ply.h"
#include "formats/mesh_io.h"
#include "planning/sparse_flags.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  int cases = 1000;
  std::uint64_t seed = 1;
  int only = -1;
  double lost = 1;  ///< share of the samples
  std::string out;
};

struct Case {
  std::string what;
  std::vector<std::vector<std::uint8_t>> on_body;  ///< by scan and sample
  std::vector<RangeGrid> grids;
  std::vector<RigidTransform> poses;
  std::vector<SampleFlags> flags;
  double sigma_mm = 0;
};

/// Those that noise and steps may have moved, and no more.
std::vector<std::uint8_t> samples_on_body(const RangeGrid& grid, const RigidTransform& pose,
                                          const OddBody& body) {
  std::vector<std::uint8_t> on_body(grid.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    on_body[i] = grid.valid[i] != 0 && std::abs(body.outside_mm(pose * grid.point(i).cast<double>())) <
                                           0.5 * grid.spacing_mm
                     ? 1
                     : 0;
  }
  return on_body;
}

Case make_case(std::uint64_t seed) {
  Random random(seed);
  Case out;
  const OddBody body(random);
  out.what = body.name();
  const int scans = 1 + static_cast<int>(random.uniform(0, 7));
  const double pose_error_mm = random.uniform(0, 1) < 0.5 ? 0.0 : std::pow(10.0, random.uniform(-3, 0));
  const OddScanning scanning(random);
  out.what +=
      ", " + scanning.name() + (pose_error_mm > 0 ? ", poses off by " + std::to_string(pose_error_mm) : "");
  for (int k = 0; k < scans; ++k) {
    if (k > 0 && random.uniform(0, 1) < 0.08) {
      out.grids.push_back(out.grids.back());  // the same scan twice
      out.on_body.push_back(out.on_body.back());
      out.poses.push_back(out.poses.back());
      continue;
    }
    auto [grid, pose] = scanning.scan(body, random);
    out.on_body.push_back(samples_on_body(grid, pose, body));
    const Eigen::Vector3d turn = 0.1 * pose_error_mm * random.normal3();
    pose = RigidTransform::from_twist(turn, pose_error_mm * random.normal3()) * pose;
    out.grids.push_back(std::move(grid));
    out.poses.push_back(pose);
  }
  out.sigma_mm = random.uniform(0, 1) < 0.5 ? pose_error_mm : 0.0;
  for (const RangeGrid& grid : out.grids) {
    out.flags.push_back(random.uniform(0, 1) < 0.7 ? flag_sparse(grid) : SampleFlags(grid.size(), 0));
  }
  return out;
}

std::vector<PlacedScan> placed_scans(const Case& of) {
  std::vector<PlacedScan> placed;
  for (std::size_t k = 0; k < of.grids.size(); ++k) {
    placed.push_back(
        {static_cast<int>(k), &of.grids[k], &of.flags[k], of.poses[k], of.sigma_mm, std::nullopt});
  }
  return placed;
}

StitchOptions options_of_all() {
  StitchOptions options;
  options.least_component_faces = 4;
  return options;
}

Mesh stitched(const Case& of) {
  const JobContext job;
  Result<Mesh> mesh = stitch(placed_scans(of), options_of_all(), job);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().line().c_str());
    return {};
  }
  return std::move(*mesh);
}

/// The same scans after they have come and gone in any order, with updates and meshes in between, some of
/// them stopped on the way.
Mesh stitched_by_detours(const Case& of, std::uint64_t seed) {
  Random random(seed);
  std::vector<PlacedScan> placed = placed_scans(of);
  for (std::size_t k = placed.size(); k > 1; --k) {
    std::swap(placed[k - 1], placed[random.below(k)]);
  }
  Stitcher stitcher(options_of_all());
  const JobContext job;
  const auto pause = [&] {
    std::uint64_t left = random.below(12);  // 0: to the end
    JobContext* stopped = nullptr;
    JobContext some([&](std::string_view, double) {
      if (left > 0 && --left == 0) {
        stopped->cancel();
      }
    });
    stopped = &some;
    const std::uint64_t what = random.below(4);
    if (what == 0) {
      (void)stitcher.mesh(some);
    } else if (what == 1) {
      (void)stitcher.update(some);
    }
  };
  const std::uint64_t detours = random.below(placed.size() + 1);
  for (std::uint64_t k = 0; k < detours; ++k) {
    const PlacedScan& scan = placed[random.below(placed.size())];
    if (!stitcher.remove(scan.id)) {
      (void)stitcher.add(scan, job);
    }
    pause();
  }
  for (const PlacedScan& scan : placed) {
    stitcher.remove(scan.id);
    (void)stitcher.add(scan, job);
    pause();
  }
  return stitcher.mesh();
}

bool same(const Mesh& a, const Mesh& b) {
  return a.faces == b.faces && a.reliability == b.reliability && a.sigma_mm == b.sigma_mm &&
         a.scans == b.scans && a.flags == b.flags &&
         std::ranges::equal(a.positions, b.positions,
                            [](const auto& p, const auto& q) { return (p.array() == q.array()).all(); });
}

/// Vertices that lie where another does: whoever welds equal places joins them.
std::size_t shared_places(const Mesh& mesh) {
  std::set<std::array<float, 3>> places;
  for (const Eigen::Vector3f& p : mesh.positions) {
    places.insert({p.x(), p.y(), p.z()});
  }
  return mesh.positions.size() - places.size();
}

/// Stitches a case again by detours and says what is wrong with it; true when nothing is.
bool is_sound(int number, const Case& one, const Mesh& mesh, std::uint64_t seed) {
  const MeshReport report = check_mesh(mesh);
  const bool same_again = same(mesh, stitched_by_detours(one, seed));
  if (report.is_manifold() && report.self_intersections == 0 && report.unreferenced_vertices == 0 &&
      same_again && shared_places(mesh) == 0) {
    return true;
  }
  std::printf(
      "%d: %s: %zu scans, %zu faces; non-manifold edges %zu, vertices %zu; inconsistent %zu, degenerate %zu, "
      "duplicate %zu, self-intersections %zu, unreferenced %zu, in one place %zu%s\n",
      number, one.what.c_str(), one.grids.size(), report.faces, report.non_manifold_edges,
      report.non_manifold_vertices, report.inconsistent_faces, report.degenerate_faces,
      report.duplicate_faces, report.self_intersections, report.unreferenced_vertices, shared_places(mesh),
      same_again ? "" : "; another mesh in another order");
  std::fflush(stdout);
  return false;
}

/// Share of the samples that are farther than the spacing from the mesh, though the body is there and their
/// neighbours are good.
double share_lost(const Case& one, const Mesh& mesh) {
  const MeshQuery query(mesh);
  std::size_t all = 0;
  std::size_t lost = 0;
  for (std::size_t s = 0; s < one.grids.size(); ++s) {
    const RangeGrid& grid = one.grids[s];
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (one.on_body[s][i] != 0 && is_unflagged(one.flags[s][i])) {
        const Eigen::Vector3f p = (one.poses[s] * grid.point(i).cast<double>()).cast<float>();
        ++all;
        lost += query.closest(p, static_cast<float>(grid.spacing_mm)) ? 0 : 1;
      }
    }
  }
  return all > 0 ? static_cast<double>(lost) / static_cast<double>(all) : 0.0;
}

Status keep(const std::filesystem::path& folder, const Case& one, const Mesh& mesh) {
  std::filesystem::create_directories(folder);
  Status kept = write_mesh(folder / "mesh.ply", mesh);
  for (std::size_t s = 0; s < one.grids.size() && kept; ++s) {
    kept = write_grid_ply(folder / ("scan" + std::to_string(s) + ".ply"), one.grids[s]);
    std::ofstream(folder / ("pose" + std::to_string(s) + ".txt"))
        << one.poses[s].rotation << '\n'
        << one.poses[s].translation_mm.transpose() << '\n';
  }
  return kept;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments args;
  CLI::App app("stitching scans that no tablet gives");
  app.add_option("--cases", args.cases)->capture_default_str();
  app.add_option("--seed", args.seed)->capture_default_str();
  app.add_option("--only", args.only);
  app.add_option("--lost", args.lost)->check(CLI::Range(0.0, 1.0));
  app.add_option("-o", args.out);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  int faulty = 0;
  int empty = 0;
  std::size_t faces = 0;
  const int from = args.only < 0 ? 0 : args.only;
  const int to = args.only < 0 ? args.cases : args.only + 1;
  for (int k = from; k < to; ++k) {
    const std::uint64_t seed = seed_for(args.seed, static_cast<std::uint64_t>(k));
    const Case one = make_case(seed);
    const Mesh mesh = stitched(one);
    faces += mesh.faces.size();
    empty += mesh.faces.empty() ? 1 : 0;
    if (const double lost = args.lost < 1 ? share_lost(one, mesh) : 0; lost > args.lost) {
      std::printf("%d: %s: %zu scans, %zu faces; %.2f %% of the samples lost\n", k, one.what.c_str(),
                  one.grids.size(), mesh.faces.size(), 100 * lost);
    }
    const bool sound = is_sound(k, one, mesh, seed);
    faulty += sound ? 0 : 1;
    if (args.out.empty() || (sound && args.only < 0)) {
      continue;
    }
    if (const Status kept = keep(std::filesystem::path(args.out) / std::to_string(k), one, mesh); !kept) {
      std::fprintf(stderr, "dubsar-odd-scans: %s\n", kept.error().line().c_str());
      return 2;
    }
  }
  std::printf("%d cases, %.2f million faces, %d without a face, %d with a fault\n", to - from,
              1e-6 * static_cast<double>(faces), empty, faulty);
  return faulty == 0 ? 0 : 1;
}
