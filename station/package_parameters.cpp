// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the steps of a package were done with, for its provenance.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>

#include "formats/rig_json.h"
#include "planning/red_map.h"
#include "registration/registrar.h"
#include "station/analysis.h"
#include "station/made_by.h"
#include "station/package_content.h"
#include "station/session_wedges.h"
#include "triangulation/stitcher.h"

namespace dubsar {

namespace {

/// The lateral spacings of the scans in the model: what every threshold in µ goes by.
void add_spacing(const PackageContent& content, std::vector<ProvenanceValue>& values) {
  const auto scans = content.store.scans();
  double finest_mm = 0;
  double coarsest_mm = 0;
  for (const StoredScan& scan : scans ? *scans : std::vector<StoredScan>()) {
    if (!scan.dropped && !scan.damaged && scan.spacing_mm > 0) {
      finest_mm = finest_mm > 0 ? std::min(finest_mm, scan.spacing_mm) : scan.spacing_mm;
      coarsest_mm = std::max(coarsest_mm, scan.spacing_mm);
    }
  }
  values.push_back({"finest lateral spacing of the scans", finest_mm, "mm"});
  values.push_back({"coarsest lateral spacing of the scans", coarsest_mm, "mm"});
}

/// As its author wrote it: 0.3F is 0.3, not 0.30000001192092896.
double as_written(float value) {
  const std::string text = fmt::format("{}", value);
  double out = 0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

}  // namespace

std::string keeper_of(const PackageContent& content) {
  return content.facts.program.empty() ? program_name() : content.facts.program;
}

std::string placer_of(const PackageContent& content) {
  const std::string placed = made_by(content.store).placed;
  return placed.empty() ? program_name() : placed;
}

std::string judge_of(const PackageContent& content) {
  const std::string judged = content.source.pages() ? made_by(content.store).judged : std::string();
  return judged.empty() ? program_name() : judged;
}

std::string measurer_of(const PackageContent& content) {
  if (!content.wedges_are_kept) {
    return program_name();
  }
  // A version after the one that scanned may have measured them anew: at the signature, say.
  return content.wedges->program.empty() ? keeper_of(content) : content.wedges->program;
}

std::vector<ProvenanceValue> registration_parameters(const PackageContent& content) {
  std::vector<ProvenanceValue> out;
  add_spacing(content, out);
  if (placer_of(content) == program_name()) {
    const RegistrationOptions options;
    out.push_back({"fewest samples of a scan", static_cast<double>(options.least_samples), ""});
    out.push_back({"final rounds of fits and relaxation", static_cast<double>(options.final_rounds), ""});
  }
  return out;
}

std::vector<ProvenanceValue> verdict_parameters(const PackageContent& content) {
  std::vector<ProvenanceValue> out;
  add_spacing(content, out);
  const auto text = content.store.load_document("rig");
  if (text && *text) {
    if (const Result<Rig> rig = parse_rig(**text, "rig")) {
      out.push_back({"lateral spacing of the rig", rig->spacing_mm, "mm"});
    }
  }
  if (judge_of(content) == program_name()) {
    const ExcuseOptions excuse = RedMapOptions().excuse;
    out.push_back({"largest error of what is interpolated", excuse.interpolation_mm, "mm"});
    out.push_back({"largest gap that is excused", excuse.largest_gap_mm, "mm"});
    out.push_back({"least chance of a place within reach", excuse.least_chance, ""});
  }
  return out;
}

std::vector<ProvenanceValue> stitching_parameters(const PackageContent& content) {
  std::vector<ProvenanceValue> out;
  add_spacing(content, out);
  out.push_back(
      {"fewest triangles of a piece", static_cast<double>(StitchOptions().least_component_faces), ""});
  return out;
}

std::vector<ProvenanceValue> analysis_parameters(const PackageContent& content) {
  std::vector<ProvenanceValue> out{
      {"corrections by a person", static_cast<double>(content.wedges->corrections), ""}};
  if (measurer_of(content) == program_name()) {
    const AnalysisOptions options;
    const FreeSurfaceOptions& free = options.fields.free_surface;
    out.push_back({"free surface: mean curvature no further below zero than",
                   as_written(free.most_concave_per_mm), "1/mm"});
    out.push_back({"scale of the curvature", as_written(free.scale_mm), "mm"});
    out.push_back(
        {"rings of faces around a fault", static_cast<double>(options.fields.reliability_iterations), ""});
    out.push_back({"weight of a point off the free surface",
                   as_written(options.fields.reconstruction.other_weight), ""});
    out.push_back({"depth from which that weight falls, as one over the depth",
                   as_written(options.fields.reconstruction.full_depth_mm), "mm"});
    out.push_back({"smallest hollow", options.wedges.min_basin_mm2, "mm2"});
    out.push_back({"shallowest hollow", options.wedges.min_basin_depth_mm, "mm"});
  }
  return out;
}

std::string analysis_note(const WedgeFile& wedges) {
  const std::string note = wedges.exits == ExitDefinition::kSurface
                               ? "Inner edges end at the free surface."
                               : "Inner edges end where they are seen to.";
  const std::string by_hand = correction_sentence(wedges);
  return by_hand.empty() ? note : note + " " + by_hand;
}

}  // namespace dubsar
