// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze: what it is asked for on the command line.

#include <memory>
#include <string>
#include <vector>

#include "core/units.h"
#include "station/command/analyze.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"

namespace dubsar {

std::filesystem::path corrections_of(const AnalyzeArguments& arguments) {
  return arguments.corrections.empty() ? corrections_file_of(arguments.out)
                                       : std::filesystem::path(arguments.corrections);
}

std::vector<std::string> written_by(const AnalyzeArguments& arguments) {
  return {arguments.out, arguments.mesh_out, as_folder(arguments.pictures), as_folder(arguments.svg),
          arguments.invariants};
}

void add_analyze_options(CLI::App& verb, AnalyzeArguments& arguments) {
  verb.add_option("mesh", arguments.in, "PLY, OBJ, STL or GLB, faults and all")->required();
  verb.add_option("-o,--out", arguments.out, "wedges.json")->required();
  verb.add_option("--mesh-out", arguments.mesh_out, "the mesh with its wedges in colours");
  verb.add_option(
          "--exit", arguments.exits,
          "where an inner edge ends: surface, at the free surface (unless said); extent, as far as seen")
      ->check(CLI::IsMember({"surface", "extent"}));
  verb.add_option("--unit", arguments.unit,
                  "what the file's numbers are; default: its own word, else mm, or what its size tells")
      ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
  verb.add_option("--pictures", arguments.pictures,
                  "a folder for the surface fields and the wedges as coloured PLY and PNG");
  verb.add_option("--free-openness", arguments.fields.free_surface.least_openness,
                  "free surface: at least this open, 0 to 1; unset: told by the mesh")
      ->check(in_range(0.0, 1.0));
  verb.add_option("--free-concave", arguments.fields.free_surface.most_concave_per_mm,
                  "free surface: mean curvature no further below zero than this, per mm")
      ->check(in_range(0.0, 100.0))
      ->capture_default_str();
  verb.add_flag("--equalize", arguments.fields.equalize_openness,
                "openness by rank: --free-openness is then a share of the surface");
  verb.add_option("--fault-reach", arguments.fields.reliability_iterations,
                  "how many rings of faces around a fault of the mesh are less reliable")
      ->check(in_range(0, 100))
      ->capture_default_str();
  verb.add_flag("--uniform-weights", arguments.uniform_weights,
                "all points weigh the same in the surface that heights are taken from, for comparison");
  verb.add_option("--invariants", arguments.invariants,
                  "multi-scale integral invariants of every vertex, as GigaMesh's .mat");
  verb.add_option("--invariant-radius", arguments.radius_mm, "mm, of their largest sphere")
      ->check(in_range(0.05, 50.0))
      ->capture_default_str();
  verb.add_option("--svg", arguments.svg, "a folder for one drawing to scale of each side that has wedges");
  verb.add_flag("--classical-watershed", arguments.classical, "the textbook watershed, for comparison");
  verb.add_flag("--again", arguments.again, "even where the same was done before from the same mesh");
  verb.add_option("--corrections", arguments.corrections,
                  "what a person has said of the wedges; without it NAME.corrections.json beside the output");
}

void add_analyze(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("analyze", "Every wedge of a mesh, measured");
  const auto arguments = std::make_shared<AnalyzeArguments>();
  add_analyze_options(*verb, *arguments);
  verb->callback([&chosen, arguments] {
    chosen = with_safe_outputs(written_by(*arguments),
                               [arguments](CommandContext& c) { return analyze(*arguments, c); },
                               {arguments->in, corrections_of(*arguments).string()});
  });
}

}  // namespace dubsar
