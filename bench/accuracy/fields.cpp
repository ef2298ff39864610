// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The surface fields of the wedge analysis against the truth of simulated tablets: how far the height is from
// the true depth, how well the free surface is found, and how long each stage takes.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

#include "analysis/field_colours.h"
#include "analysis/integral_invariants.h"
#include "analysis/surface_fields.h"
#include "bench/support/cut_heights.h"
#include "bench/support/options.h"
#include "bench/support/true_surface.h"
#include "core/stage_times.h"
#include "core/tablet_frame.h"
#include "core/units.h"
#include "formats/feature_mat.h"
#include "formats/mesh_io.h"
#include "formats/truth_json.h"
#include "sim/tablet.h"
#include "station/field_pictures.h"

namespace {

using namespace dubsar;

struct Options {
  std::string mesh;
  std::string truth;
  std::string unit;
  std::string pictures;
  std::uint64_t seed = 0;
  std::vector<double> size{50, 40, 20};
  double spacing_mm = 0.1;
  double damage = 0;
  SurfaceFieldOptions fields;
  bool brief = false;
  bool invariants = false;
  std::string mat;
  std::string cut;
};

void print_quantiles(const char* what, std::vector<float> values) {
  if (values.empty()) {
    return;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return 1000.0 * values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  std::printf(
      "%-34s n %8zu  um: 1%% %7.1f  5%% %7.1f  25%% %7.1f  50%% %7.1f  75%% %7.1f  95%% %7.1f  99%% %7.1f\n",
      what, values.size(), at(0.01), at(0.05), at(0.25), at(0.5), at(0.75), at(0.95), at(0.99));
}

void print_kinds(const sim::SimTablet& tablet, const SurfaceFields& fields, bool brief) {
  const char* const names[] = {"body", "seal", "wedge", "fracture", "erosion", "dirt", "crack", "hole"};
  for (int kind = 0; kind < 8; ++kind) {
    std::vector<float> heights;
    std::vector<float> free_heights;
    std::size_t open = 0;
    for (std::size_t i = 0; i < tablet.kinds.size(); ++i) {
      if (static_cast<int>(tablet.kinds[i]) == kind) {
        heights.push_back(fields.height_mm[i]);
        open += fields.openness[i] >= 0.9F ? 1U : 0U;
        if (fields.free_surface[i] != 0) {
          free_heights.push_back(fields.height_mm[i]);
        }
      }
    }
    if (!heights.empty()) {
      std::printf("%-9s open %5.1f %%  free %5.1f %%\n", names[kind],
                  100.0 * static_cast<double>(open) / static_cast<double>(heights.size()),
                  100.0 * static_cast<double>(free_heights.size()) / static_cast<double>(heights.size()));
      if (!brief) {
        print_quantiles("   height, all", heights);
      }
      print_quantiles("   height, free", free_heights);
    }
  }
}

void print_depths(const std::vector<Wedge>& wedges, const SurfaceFields& fields) {
  std::vector<float> off;
  for (const Wedge& w : wedges) {
    if (w.intact >= 0.6) {
      off.push_back(-fields.surface.height_mm(w.depth_point_mm.cast<float>()) -
                    static_cast<float>(w.depth_mm));
    }
  }
  print_quantiles("depth found - true, at depth points", off);
}

int run(const Options& options) {
  JobContext job;
  Mesh mesh;
  sim::SimTablet tablet;
  std::vector<Wedge> wedges;
  if (!options.mesh.empty()) {
    auto read = read_mesh(options.mesh, {mm_per_unit(options.unit)});
    if (!read) {
      std::fprintf(stderr, "%s\n", read.error().line().c_str());
      return 2;
    }
    mesh = std::move(*read);
    if (!options.truth.empty()) {
      auto truth = read_truth(options.truth);
      if (!truth) {
        std::fprintf(stderr, "%s\n", truth.error().line().c_str());
        return 2;
      }
      wedges = std::move(truth->wedges);
    }
  }
  if (options.mesh.empty() || options.seed > 0) {
    sim::TabletOptions making;
    making.seed = options.seed;
    making.size_mm = {options.size[0], options.size[1], options.size[2]};
    making.spacing_mm = options.spacing_mm;
    making.damage = {options.damage, options.damage, options.damage, options.damage, 0};
    auto made = sim::make_tablet(making, job);
    if (!made) {
      std::fprintf(stderr, "%s\n", made.error().line().c_str());
      return 2;
    }
    tablet = std::move(*made);
    wedges = tablet.wedges;
    if (options.mesh.empty()) {
      mesh = tablet.mesh;
    } else {
      tablet = bench::with_truth(mesh, tablet);
    }
  }
  StageTimes times;
  const auto start = std::chrono::steady_clock::now();
  const VertexGraph graph = make_vertex_graph(mesh);
  times.emplace_back("graph", seconds_since(start));
  const auto fields = compute_surface_fields(mesh, graph, options.fields, job, &times);
  if (!fields) {
    std::fprintf(stderr, "%s\n", fields.error().line().c_str());
    return 2;
  }
  std::printf("%zu vertices, %zu faces; surface of %zu vertices, cell %.2f mm\n", mesh.positions.size(),
              mesh.faces.size(), fields->surface.mesh().positions.size(), fields->surface.cell_mm());
  for (const auto& [stage, seconds] : times) {
    std::printf("%s %.2f  ", stage.c_str(), seconds);
  }
  std::printf("\n");
  print_quantiles("openness, thousandths", fields->openness);
  std::size_t is_free = 0;
  for (const std::uint8_t f : fields->free_surface) {
    is_free += f;
  }
  std::printf("free surface %.1f %% of the vertices\n",
              100.0 * static_cast<double>(is_free) / static_cast<double>(mesh.positions.size()));
  if (!tablet.kinds.empty()) {
    print_kinds(tablet, *fields, options.brief);
  }
  print_depths(wedges, *fields);
  if (!options.cut.empty()) {
    bench::print_cut_heights(mesh, *fields, options.cut, options.fields, job);
  }
  if (options.invariants || !options.mat.empty()) {
    const auto begun = std::chrono::steady_clock::now();
    const IntegralInvariants invariants =
        integral_invariants(mesh, outlook_of(mesh, *fields), fields->mean_edge_mm, {}, job);
    std::printf("integral invariants %.2f s\n", seconds_since(begun));
    if (!options.mat.empty()) {
      (void)write_feature_mat(options.mat, invariants.value, invariants.radii_mm.size(),
                              "multi-scale integral invariants");
    }
    if (!options.pictures.empty()) {
      Mesh coloured = mesh;
      coloured.colours = diverging_colours(strongest_response(invariants), 0, 0.5F);
      (void)write_six_view_picture(options.pictures + "_invariants.png", coloured, tablet_frame(mesh), {},
                                   job);
    }
  }
  if (!options.pictures.empty()) {
    if (const Status drawn =
            write_field_pictures(options.pictures, mesh, tablet_frame(mesh), *fields, {}, job);
        !drawn) {
      std::fprintf(stderr, "%s\n", drawn.error().line().c_str());
      return 2;
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"The surface fields of the wedge analysis against the truth of simulated tablets"};
  app.add_option("--mesh", options.mesh, "a mesh instead of a simulated tablet");
  app.add_option("--unit", options.unit, "of the mesh")->check(dubsar::bench::one_of(kLengthUnits));
  app.add_option("--truth", options.truth, "its truth.json");
  app.add_option("--seed", options.seed, "of the simulated tablet; with --mesh: the one that was scanned")
      ->capture_default_str();
  app.add_option("--size", options.size, "mm")->expected(3)->delimiter('x');
  app.add_option("--spacing", options.spacing_mm, "mm")->capture_default_str();
  app.add_option("--damage", options.damage)->capture_default_str();
  app.add_option("--openness", options.fields.free_surface.least_openness)->capture_default_str();
  app.add_option("--concave", options.fields.free_surface.most_concave_per_mm)->capture_default_str();
  app.add_option("--scale", options.fields.free_surface.scale_mm)->capture_default_str();
  app.add_option("--cell", options.fields.reconstruction.cell_mm)->capture_default_str();
  app.add_option("--other-weight", options.fields.reconstruction.other_weight)->capture_default_str();
  app.add_option("--screening", options.fields.reconstruction.poisson.screening)->capture_default_str();
  app.add_option("--script", options.fields.reconstruction.script_mm)->capture_default_str();
  app.add_flag("--invariants", options.invariants, "the integral invariants too");
  app.add_option("--mat", options.mat, "where to write them");
  app.add_option("--cut", options.cut, "the heights of a part beside those of the whole")
      ->check(CLI::IsMember({"half", "obverse"}));
  app.add_flag("--brief", options.brief);
  app.add_option("--pictures", options.pictures, "a folder: the fields as PLY and PNG");
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }
  return run(options);
}
