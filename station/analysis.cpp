// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/analysis.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "analysis/hollow_measure.h"
#include "analysis/text_frame.h"
#include "analysis/wedge_features.h"
#include "core/log.h"
#include "core/parallel.h"
#include "formats/corrections_json.h"
#include "station/results.h"

namespace dubsar {

namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kClay = {196, 176, 148};
constexpr Rgb kHollow = {150, 158, 172};
constexpr Rgb kBorder = {52, 84, 160};

/// A colour of its own for each number: hues by the golden ratio, so that neighbours differ.
Rgb colour_of(std::int32_t number, std::int8_t face) {
  const double hue = std::fmod(0.618033988749895 * (number + 1), 1.0) * 6.0;
  const double value = face == 0 ? 0.95 : face == 1 ? 0.80 : 0.65;
  const double x = 1.0 - std::abs(std::fmod(hue, 2.0) - 1.0);
  constexpr std::array<std::array<int, 3>, 6> kWhich = {
      {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}, {1, 2, 0}, {0, 2, 1}}};
  const std::array<double, 3> parts = {1.0, x, 0.0};
  Rgb rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double part = parts[static_cast<std::size_t>(kWhich[static_cast<std::size_t>(hue)][c])];
    rgb[c] = static_cast<std::uint8_t>(255.0 * value * (0.2 + 0.8 * part));
  }
  return rgb;
}

}  // namespace

Result<Analysis> analyze_mesh(const Mesh& mesh, const AnalysisOptions& options, const JobContext& job) {
  Analysis analysis;
  LapClock graph_clock(&analysis.timings_s);
  analysis.graph = make_vertex_graph(mesh);
  graph_clock.done("graph");
  Result<SurfaceFields> fields =
      compute_surface_fields(mesh, analysis.graph, options.fields, job, &analysis.timings_s);
  if (!fields) {
    return std::unexpected(fields.error());
  }
  analysis.fields = *std::move(fields);
  Result<WedgeFindings> findings =
      find_candidates(mesh, analysis.graph, analysis.fields, options.wedges, job, &analysis.timings_s);
  if (!findings) {
    return std::unexpected(findings.error());
  }
  analysis.findings = *std::move(findings);
  LapClock placing_clock(&analysis.timings_s);
  correct_analysis(mesh, options, &analysis);
  placing_clock.done("text frame");
  return analysis;
}

void correct_analysis(const Mesh& mesh, const AnalysisOptions& options, Analysis* analysis) {
  analysis->set = settle_wedges(mesh, analysis->graph, analysis->fields, options.wedges, analysis->findings);
  analysis->text = find_text_frame(mesh, analysis->set.wedges);
  place_wedges(analysis->text, &analysis->set.wedges);
}

void warn_of_lost(const Analysis& analysis, const std::string& where) {
  for (const LostCorrection& lost : analysis.set.lost) {
    log_warning(fmt::format("{}: correction {} is not made: {}", where, lost.index + 1, lost.reason));
  }
}

WedgeFile wedge_file(std::string mesh_name, const AnalysisOptions& options, const Analysis& analysis) {
  WedgeFile file;
  file.program = program_name();
  file.method = kWedgeMethod;
  file.mesh = std::move(mesh_name);
  file.spacing_mm = mean_spacing_mm(analysis.findings.area_mm2);
  file.exits = options.wedges.exits;
  file.wedges = analysis.set.wedges;
  file.former = analysis.set.former;
  file.profiles = make_profiles(file.wedges);
  file.rejected = analysis.set.rejected;
  file.corrections = options.wedges.corrections.size();
  if (file.corrections > 0) {
    file.corrections_xxh128 = corrections_digest(options.wedges.corrections);
  }
  file.lost = analysis.set.lost;
  file.text_from_model = analysis.text.text_from_model;
  file.text_certainty = analysis.text.certainty;
  file.timings_s = analysis.timings_s;
  return file;
}

Mesh annotated_mesh(const Mesh& mesh, const Analysis& analysis) {
  Mesh out = mesh;
  const WedgeSet& set = analysis.set;
  out.reliability = analysis.fields.reliability;
  out.normals = analysis.fields.normal;
  out.colours.resize(mesh.positions.size());
  parallel_for_each_index(mesh.positions.size(), [&](std::size_t v) {
    out.colours[v] = set.wedge_of[v] >= 0              ? colour_of(set.wedge_of[v], set.face_of[v])
                     : set.basin_of[v] >= 0            ? kHollow
                     : set.basin_of[v] == kBasinBorder ? kBorder
                                                       : kClay;
  });
  return out;
}

}  // namespace dubsar
