// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/analysis_asked.h"

#include <filesystem>
#include <type_traits>

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/wedges_json.h"
#include "station/done_stamp.h"

namespace dubsar {

AnalysisOptions options_of(const AnalysisAsked& asked, std::vector<WedgeCorrection> corrections) {
  AnalysisOptions options;
  options.fields = asked.fields;
  if (asked.uniform_weights) {
    options.fields.reconstruction.other_weight = 1;
  }
  options.wedges.exits = asked.exits == "extent" ? ExitDefinition::kExtent : ExitDefinition::kSurface;
  options.wedges.classical_watershed = asked.classical;
  options.wedges.corrections = std::move(corrections);
  return options;
}

void take_known_options(AnalysisAsked& asked, const std::function<bool(const char*)>& said) {
  const std::filesystem::path stamp_file = stamp_beside(asked.out);
  std::error_code none;
  if (!std::filesystem::is_regular_file(stamp_file, none)) {
    // A disk that was full may have cost the stamp: the file itself tells at least where its edges end.
    const Result<WedgeFile> file =
        std::filesystem::is_regular_file(asked.out, none) ? read_wedges(asked.out) : WedgeFile();
    if (file && !said("--exit")) {
      asked.exits = file->exits == ExitDefinition::kExtent ? "extent" : "surface";
    }
    return;
  }
  const Result<std::string> text = read_whole_file(stamp_file, kMaxJsonBytes);
  const Result<DoneStamp> stamp =
      text ? parse_done_stamp(*text, stamp_file.string()) : std::unexpected(text.error());
  const Result<JsonDocument> known = stamp && stamp->verb == "analyze"
                                         ? JsonDocument::parse(stamp->parameters, stamp_file.string())
                                         : bad_input(stamp_file.string(), "is no stamp of an analysis");
  if (!known) {
    return;
  }
  const JsonNode root = known->root();
  AnalysisAsked a = asked;
  const auto number = [&](const char* option, const char* key, auto& value) {
    value = said(option) ? value : static_cast<std::decay_t<decltype(value)>>(root.at(key).number());
  };
  const auto flag = [&](const char* option, const char* key, bool& value) {
    value = said(option) ? value : root.at(key).boolean();
  };
  const auto word = [&](const char* option, const char* key, std::string& value) {
    value = said(option) ? value : root.at(key).text();
  };
  const auto place = [&](const char* option, const char* key, std::string& value) {
    const std::string relative = root.at(key).text();
    if (!said(option) && !relative.empty()) {
      value = (folder_of(asked.out) / relative).lexically_normal().string();
    }
  };
  FreeSurfaceOptions& free = a.fields.free_surface;
  word("--exit", "exit", a.exits);
  word("--unit", "unit", a.unit);
  number("--free-openness", "free_openness", free.least_openness);
  number("--free-concave", "free_concave_per_mm", free.most_concave_per_mm);
  flag("--equalize", "equalize", a.fields.equalize_openness);
  number("--fault-reach", "fault_reach", a.fields.reliability_iterations);
  flag("--uniform-weights", "uniform_weights", a.uniform_weights);
  flag("--classical-watershed", "classical_watershed", a.classical);
  place("--mesh-out", "mesh_out", a.mesh_out);
  place("--pictures", "pictures", a.pictures);
  place("--svg", "svg", a.svg);
  place("--invariants", "invariants", a.invariants);
  if (!a.invariants.empty()) {
    number("--invariant-radius", "invariant_radius_mm", a.radius_mm);
  }
  if (known->status("")) {
    asked = std::move(a);
  }
}

}  // namespace dubsar
