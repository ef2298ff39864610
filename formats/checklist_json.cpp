// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/checklist_json.h"

#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

std::string checklist_to_json(const Checklist& checklist) {
  OrderedJson root;
  root["conclusive"] = checklist.conclusive;
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    const FaceCoverage& coverage = checklist.faces[face];
    OrderedJson json;
    json["seen_mm2"] = coverage.seen_mm2;
    json["red_mm2"] = coverage.red_mm2;
    json["excused_mm2"] = coverage.excused_mm2;
    root["faces"][to_string(static_cast<Face>(face))] = std::move(json);
  }
  root["scans_registered"] = checklist.scans_registered;
  root["scans_unsure"] = checklist.scans_unsure;
  root["scans_failed"] = checklist.scans_failed;
  root["calibration"] = checklist.calibration;
  if (checklist.calibration_age_days) {
    root["calibration_age_days"] = *checklist.calibration_age_days;
  }
  root["disk_free_gib"] = checklist.disk_free_gib;
  root["store_whole"] = checklist.store_whole;
  return text_of(root);
}

Result<Checklist> parse_checklist(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const auto count = [&](const char* key) {
    return static_cast<int>(root.at(key).integer(0, std::numeric_limits<int>::max()));
  };
  Checklist checklist;
  checklist.conclusive = root.at("conclusive").boolean();
  const JsonNode faces = root.at("faces");
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    const JsonNode node = faces.at(to_string(static_cast<Face>(face)));
    checklist.faces[face] = {node.at("seen_mm2").number(0), node.at("red_mm2").number(0),
                             node.at("excused_mm2").number(0)};
  }
  checklist.scans_registered = count("scans_registered");
  checklist.scans_unsure = count("scans_unsure");
  checklist.scans_failed = count("scans_failed");
  checklist.calibration = root.at("calibration").text();
  if (const auto age = root.find("calibration_age_days")) {
    checklist.calibration_age_days = age->number();
  }
  checklist.disk_free_gib = root.at("disk_free_gib").number(0);
  checklist.store_whole = root.at("store_whole").boolean();
  if (Status status = document->status("write the checklist again"); !status) {
    return std::unexpected(status.error());
  }
  return checklist;
}

}  // namespace dubsar
