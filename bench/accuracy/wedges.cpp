// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Wedges found on simulated tablets of differing seed and damage against the truth: precision, recall and F1
// of those at least 60 % intact, and how far the measures are off. On the clean meshes, on the same scanned
// in simulation and stitched with true poses, and with faults put into the mesh.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "analysis/wedges.h"
#include "bench/support/confidence_diagram.h"
#include "bench/support/mesh_faults.h"
#include "bench/support/options.h"
#include "bench/support/other_tablet.h"
#include "bench/support/true_scans.h"
#include "bench/support/true_surface.h"
#include "bench/support/wedge_score.h"
#include "formats/mesh_io.h"
#include "formats/truth_json.h"
#include "planning/sparse_flags.h"
#include "sim/tablet.h"
#include "triangulation/stitcher.h"

namespace {

using namespace dubsar;
using namespace dubsar::bench;

struct Arguments {
  int tablets = 6;
  std::uint64_t first = 1;
  double spacing_mm = 0.1;
  double damage = -1;  ///< below zero: from none to heavy by seed
  double least_damage = 0;
  bool scanned = false;
  double scan_spacing_mm = 0.05;
  double clay_spacing_mm = 0;  ///< of the mesh that is scanned; 0: by the scans' spacing
  double noise_mm = 0.02;
  int views = 14;
  std::string keep;
  std::vector<std::string> folders;
  bool other = false;
  bool faults = false;
  bool evidence = false;
  bool verbose = false;
};

[[noreturn]] void give_up(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  std::exit(2);
}

/// The tablet scanned in simulation and stitched with the poses that were true.
Mesh scanned_mesh(const sim::TabletOptions& tablet, const Arguments& args) {
  TrueScanOptions options;
  options.spacing_mm = args.scan_spacing_mm;
  options.noise_mm = args.noise_mm;
  options.views = args.views;
  options.seed = tablet.seed;
  const std::vector<TrueScan> scans = true_scans(tablet, options);
  std::vector<SampleFlags> flags;
  std::vector<PlacedScan> placed;
  for (const TrueScan& scan : scans) {
    flags.push_back(flag_sparse(*scan.grid));
  }
  for (std::size_t i = 0; i < scans.size(); ++i) {
    placed.push_back(
        {static_cast<int>(i), scans[i].grid.get(), &flags[i], scans[i].tablet_from_scanner, 0.005});
  }
  JobContext job;
  Result<Mesh> mesh = stitch(placed, {}, job);
  if (!mesh) {
    give_up(mesh.error());
  }
  return *std::move(mesh);
}

void report(const char* name, const WedgeScore& s) {
  std::printf(
      "%-24s P %.3f R %.3f F1 %.3f | right %d false %d missed %d remains %d | depth point %.0f um, depth "
      "%.0f um, "
      "edge %.2f deg, opening %.2f deg, directional %.1f %%\n",
      name, s.precision(), s.recall(), s.f1(), s.right, s.false_ones, s.missed, s.ignored,
      median(s.depth_point_um), median(s.depth_um), median(s.edge_deg), median(s.opening_deg),
      s.right > 0 ? 100.0 * s.directional_right / s.right : 0.0);
}

/// Precision where the clay is broken, with remains of true wedges as wedges.
void report_fractures(const FractureScore& s, int tablets) {
  const auto share = [](int right, int wrong) {
    return right + wrong > 0 ? static_cast<double>(right) / (right + wrong) : 1.0;
  };
  std::printf(
      "fractures: of %d found that lie on or touch one %.3f are wedges, of %d that lie on one %.3f; %.2f "
      "false ones a tablet touch one; depths of the right ones %.0f um off (median)\n",
      s.right_touching + s.false_touching, share(s.right_touching, s.false_touching), s.right_on + s.false_on,
      share(s.right_on, s.false_on), tablets > 0 ? static_cast<double>(s.false_touching) / tablets : 0.0,
      median(s.depth_um));
}

/// How a found wedge lies to the true one that most of its vertices belong to.
void describe(const Wedge& w, const std::vector<Wedge>& truth, const std::map<int, int>& owners,
              const std::vector<int>& pair) {
  const auto most = std::ranges::max_element(owners, {}, [](const auto& o) { return o.second; });
  if (most == owners.end() || most->first < 0) {
    return;
  }
  const Wedge& t = truth[static_cast<std::size_t>(most->first)];
  const bool found = std::ranges::find(pair, most->first) != pair.end();
  const auto tail = [](const Wedge& wedge) -> Eigen::Vector3d {
    return wedge.exit_points_mm[static_cast<std::size_t>(wedge.directional_edge)] - wedge.depth_point_mm;
  };
  const Eigen::Vector3d to = w.depth_point_mm - t.depth_point_mm;
  std::printf("; owner %d depth %.2f tail %.2f intact %.2f along %.2f off %.2f cos %.2f", most->first,
              t.depth_mm, tail(t).norm(), t.intact, to.dot(tail(t).normalized()),
              (to - to.dot(tail(t).normalized()) * tail(t).normalized()).norm(),
              tail(w).normalized().dot(tail(t).normalized()));
  std::printf(", %s", found ? "found" : "missed");
}

/// Errors against the standard deviations that go with the measures.
void report_sigmas(const WedgeScore& s) {
  const auto line = [](const char* what, const std::vector<double>& sigmas) {
    const auto within = std::ranges::count_if(sigmas, [](double v) { return v <= 2.0; });
    std::printf(
        "%s error in its own sigmas: median %.2f, %.1f %% within two\n", what, median(sigmas),
        sigmas.empty() ? 0.0 : 100.0 * static_cast<double>(within) / static_cast<double>(sigmas.size()));
  };
  line("depth point", s.depth_point_sigmas);
  line("depth", s.depth_sigmas);
  line("inner edge", s.edge_sigmas);
  line("opening angle", s.opening_sigmas);
  line("edge length", s.length_sigmas);
  line("face angle", s.face_angle_sigmas);
  std::printf(
      "found less true, medians: depths %+.1f um, edge lengths %+.1f um, opening angles %+.2f deg, "
      "face angles %+.2f deg\n",
      median(s.depth_off_um), median(s.length_off_um), median(s.opening_off_deg),
      median(s.face_angle_off_deg));
}

void explain(const sim::SimTablet& tablet, const WedgeSet& set, const std::vector<int>& pair) {
  std::vector<int> of_truth(tablet.wedges.size(), -1);
  for (std::size_t f = 0; f < pair.size(); ++f) {
    const Wedge& w = set.wedges[f];
    if (pair[f] >= 0) {
      of_truth[static_cast<std::size_t>(pair[f])] = static_cast<int>(f);
      continue;
    }
    double nearest = 1e9;
    std::size_t which = 0;
    for (std::size_t t = 0; t < tablet.wedges.size(); ++t) {
      const double d = (tablet.wedges[t].depth_point_mm - w.depth_point_mm).norm();
      which = d < nearest ? t : which;
      nearest = std::min(nearest, d);
    }
    std::map<int, int> kinds;
    std::map<int, int> owners;
    for (std::size_t v = 0; v < set.wedge_of.size(); ++v) {
      if (set.wedge_of[v] == w.id) {
        ++kinds[static_cast<int>(tablet.kinds[v])];
        ++owners[tablet.wedge_of[v]];
      }
    }
    std::printf(
        "  FALSE at (%.2f %.2f %.2f) depth %.2f intact %.2f lengths %.2f %.2f %.2f conf %.2f n %d; kinds",
        w.depth_point_mm.x(), w.depth_point_mm.y(), w.depth_point_mm.z(), w.depth_mm, w.intact,
        w.edge_lengths_mm[0], w.edge_lengths_mm[1], w.edge_lengths_mm[2], w.confidence, w.vertex_count);
    for (const auto& [kind, count] : kinds) {
      std::printf(" %d:%d", kind, count);
    }
    std::printf("; nearest true %zu %.2f intact %.2f taken %d depth %.2f; of", which, nearest,
                tablet.wedges[which].intact,
                static_cast<int>(std::ranges::count(pair, static_cast<int>(which))),
                tablet.wedges[which].depth_mm);
    for (const auto& [owner, count] : owners) {
      std::printf(" %d:%d", owner, count);
    }
    describe(w, tablet.wedges, owners, pair);
    std::printf("\n");
  }
  for (std::size_t t = 0; t < of_truth.size(); ++t) {
    const Wedge& w = tablet.wedges[t];
    if (of_truth[t] >= 0 || w.intact < 0.6) {
      continue;
    }
    double near = 1e9;
    std::string why = "nothing";
    for (const RejectedWedge& r : set.rejected) {
      if (const double d = (r.depth_point_mm - w.depth_point_mm).norm(); d < near) {
        near = d;
        why = r.reason;
      }
    }
    double near_found = 1e9;
    for (const Wedge& f : set.wedges) {
      near_found = std::min(near_found, (f.depth_point_mm - w.depth_point_mm).norm());
    }
    std::printf(
        "  MISSED %zu at (%.2f %.2f %.2f) intact %.2f depth %.2f lengths %.2f %.2f %.2f; nearest found %.2f, "
        "rejected %.2f: %s\n",
        t, w.depth_point_mm.x(), w.depth_point_mm.y(), w.depth_point_mm.z(), w.intact, w.depth_mm,
        (w.exit_points_mm[0] - w.depth_point_mm).norm(), (w.exit_points_mm[1] - w.depth_point_mm).norm(),
        (w.exit_points_mm[2] - w.depth_point_mm).norm(), near_found, near, why.c_str());
  }
}

/// Finds the wedges of a mesh and prints the score.
WedgeScore judge(const std::string& name, sim::SimTablet tablet, const Arguments& args) {
  if (args.faults) {
    add_faults(1, &tablet.mesh);
    tablet.kinds.resize(tablet.mesh.positions.size());
    tablet.wedge_of.resize(tablet.mesh.positions.size(), -1);
  }
  JobContext job;
  StageTimes times;
  const VertexGraph graph = make_vertex_graph(tablet.mesh);
  Result<SurfaceFields> fields = compute_surface_fields(tablet.mesh, graph, {}, job, &times);
  if (!fields) {
    give_up(fields.error());
  }
  WedgeOptions options;
  options.judge.least_confidence = args.evidence ? 0.0 : options.judge.least_confidence;
  const auto set = find_wedges(tablet.mesh, graph, *fields, options, job, &times);
  if (!set) {
    give_up(set.error());
  }
  std::vector<int> pair;
  WedgeScore score = score_wedges(set->wedges, tablet.wedges, {}, &pair);
  score.fracture = score_fractures(graph, set->wedge_of, tablet.kinds, pair, set->wedges, tablet.wedges, {});
  report(name.c_str(), score);
  for (std::size_t f = 0; f < pair.size() && args.evidence; ++f) {
    std::printf("evidence %d %.4f", pair[f] >= 0 ? 1 : 0, set->wedges[f].confidence);
    for (const double value : set->evidence[f]) {
      std::printf(" %.4f", value);
    }
    std::printf("\n");
  }
  if (args.verbose) {
    for (const auto& [stage, seconds] : times) {
      std::printf("  %s %.2f s", stage.c_str(), seconds);
    }
    std::printf("\n");
    explain(tablet, *set, pair);
  }
  return score;
}

WedgeScore judge_folder(const std::string& folder, const Arguments& args) {
  const std::filesystem::path path(folder);
  const auto truth = read_truth(path / "truth.json");
  if (!truth) {
    give_up(truth.error());
  }
  Result<Mesh> mesh = read_mesh(path / truth->mesh);
  if (!mesh) {
    give_up(mesh.error());
  }
  sim::SimTablet tablet = sim::tablet_from_mesh(*std::move(mesh));
  tablet.wedges = truth->wedges;
  return judge(folder, std::move(tablet), args);
}

std::filesystem::path kept_folder(const Arguments& args, std::uint64_t seed) {
  return std::filesystem::path(args.keep) / ("seed" + std::to_string(seed));
}

WedgeScore judge_seed(std::uint64_t seed, double damage, const Arguments& args) {
  sim::TabletOptions options = random_tablet(seed, "text", args.spacing_mm);
  options.damage = {damage, damage, damage, damage, 0};
  if (args.scanned) {
    options.spacing_mm =
        args.clay_spacing_mm > 0 ? args.clay_spacing_mm : std::max(0.04, 0.8 * args.scan_spacing_mm);
  }
  JobContext job;
  Result<sim::SimTablet> tablet = args.other
                                      ? make_other_tablet({seed, args.spacing_mm, damage, args.noise_mm})
                                      : sim::make_tablet(options, job);
  if (!tablet) {
    give_up(tablet.error());
  }
  if (args.scanned) {
    const std::filesystem::path kept = kept_folder(args, seed) / "mesh.ply";
    Result<Mesh> mesh = std::filesystem::exists(kept) ? read_mesh(kept) : scanned_mesh(options, args);
    if (!mesh) {
      give_up(mesh.error());
    }
    *tablet = with_truth(*std::move(mesh), *tablet);
  }
  char name[96];
  std::snprintf(name, sizeof name, "seed %d damage %.1f %zuk", static_cast<int>(seed), damage,
                tablet->mesh.positions.size() / 1000);
  if (!args.keep.empty() && !std::filesystem::exists(kept_folder(args, seed) / "truth.json")) {
    const std::filesystem::path folder = kept_folder(args, seed);
    std::filesystem::create_directories(folder);
    TabletTruth truth{"mesh.ply", seed, options.size_mm, options.spacing_mm, tablet->wedges};
    Status kept = write_mesh(folder / "mesh.ply", tablet->mesh);
    kept = kept ? write_truth(folder / "truth.json", truth) : kept;
    if (!kept) {
      give_up(kept.error());
    }
  }
  return judge(name, *std::move(tablet), args);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments args;
  CLI::App app("Wedges against the truth of simulated tablets");
  app.add_option("--tablets", args.tablets);
  app.add_option("--first", args.first, "first seed");
  app.add_option("--spacing", args.spacing_mm, "of the clean mesh, mm");
  app.add_option("--damage", args.damage, "0 to 1 for all; otherwise from none to heavy by seed");
  app.add_option("--least-damage", args.least_damage, "what the first seed has, where it goes by seed");
  app.add_flag("--scanned", args.scanned, "scan each tablet in simulation and stitch the scans");
  app.add_option("--scan-spacing", args.scan_spacing_mm);
  app.add_option("--clay-spacing", args.clay_spacing_mm, "of the mesh that is scanned, mm");
  app.add_option("--noise", args.noise_mm);
  app.add_option("--views", args.views);
  app.add_option("--keep", args.keep,
                 "write each mesh and its truth into a folder here; a scanned mesh that lies there, of the "
                 "same seed and options, is taken as it is");
  app.add_option("folders", args.folders, "folders with a truth.json and its mesh, in place of seeds");
  app.add_flag("--other", args.other, "tablets of another make than the simulator's");
  app.add_flag("--faults", args.faults, "1 % of the faces deleted, 1 % doubled or flipped, loose scraps");
  app.add_flag("--evidence", args.evidence, "print what each candidate shows, and whether it is a wedge");
  app.add_flag("--verbose", args.verbose);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  WedgeScore all;
  for (const std::string& folder : args.folders) {
    all.add(judge_folder(folder, args));
  }
  for (int i = 0; i < args.tablets && args.folders.empty(); ++i) {
    const double along = static_cast<double>(i) / std::max(1, args.tablets - 1);
    const double damage =
        args.damage >= 0 ? args.damage : args.least_damage + (1.0 - args.least_damage) * along;
    all.add(judge_seed(args.first + static_cast<std::uint64_t>(i), damage, args));
  }
  report("all", all);
  report_sigmas(all);
  report_fractures(all.fracture, args.tablets);
  print_confidence_diagram(all.right_confidence, all.false_confidence);
  return 0;
}
