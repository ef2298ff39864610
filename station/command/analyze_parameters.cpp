// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an analysis is done with, as the stamp beside its output keeps it; read back by take_known_options().

#include <filesystem>

#include "analysis/wedges.h"
#include "station/command/analyze.h"
#include "station/command/outputs.h"

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

}  // namespace dubsar
