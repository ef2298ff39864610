// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an analysis was done with, as the stamp beside its output keeps it: written and read back.

#include <filesystem>
#include <type_traits>

#include "analysis/wedges.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/wedges_json.h"
#include "station/command/analyze.h"
#include "station/command/outputs.h"
#include "station/done_stamp.h"

namespace dubsar {

std::string parameters_of(const AnalyzeArguments& a, const CorrectionFile& said,
                          const std::optional<FileLabel>& of_session) {
  const FreeSurfaceOptions& free = a.fields.free_surface;
  nlohmann::ordered_json json{{"wedge_method", kWedgeMethod},
                              {"exit", a.exits},
                              {"unit", a.unit},
                              {"free_openness", free.least_openness},
                              {"free_concave_per_mm", free.most_concave_per_mm},
                              {"equalize", a.fields.equalize_openness},
                              {"fault_reach", a.fields.reliability_iterations},
                              {"uniform_weights", a.uniform_weights},
                              {"classical_watershed", a.classical},
                              {"out", std::filesystem::path(a.out).filename().string()},
                              {"mesh_out", from_folder_of(a.mesh_out, a.out)},
                              {"pictures", from_folder_of(a.pictures, a.out)},
                              {"svg", from_folder_of(a.svg, a.out)},
                              {"invariants", from_folder_of(a.invariants, a.out)},
                              {"invariant_radius_mm", a.invariants.empty() ? 0.0 : a.radius_mm}};
  if (!said.corrections.empty()) {
    json["corrections"] = corrections_to_json({{}, said.corrections});
  }
  if (of_session) {
    json["label"] = label_lines(*of_session, "");
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void take_known_options(AnalyzeArguments& arguments, const std::function<bool(const char*)>& said) {
  const std::filesystem::path stamp_file = stamp_beside(arguments.out);
  std::error_code none;
  if (!std::filesystem::is_regular_file(stamp_file, none)) {
    // A disk that was full may have cost the stamp: the file itself tells at least where its edges end.
    const Result<WedgeFile> file =
        std::filesystem::is_regular_file(arguments.out, none) ? read_wedges(arguments.out) : WedgeFile();
    if (file && !said("--exit")) {
      arguments.exits = file->exits == ExitDefinition::kExtent ? "extent" : "surface";
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
  AnalyzeArguments a = arguments;
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
      value = (folder_of(arguments.out) / relative).lexically_normal().string();
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
    arguments = std::move(a);
  }
}

}  // namespace dubsar
