// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/truth_json.h"

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/wedge_json.h"

namespace dubsar {

std::string truth_to_json(const TabletTruth& truth) {
  OrderedJson root;
  root["unit"] = "mm";
  root["mesh"] = truth.mesh;
  root["seed"] = truth.seed;
  root["size"] = json_of(truth.size_mm);
  root["spacing_mm"] = truth.spacing_mm;
  root["wedges"] = OrderedJson::array();
  for (const Wedge& wedge : truth.wedges) {
    root["wedges"].push_back(wedge_json(wedge));
  }
  root["rejected"] = OrderedJson::array();
  root["timings_s"] = OrderedJson::object();
  return text_of(root);
}

Status write_truth(const std::filesystem::path& path, const TabletTruth& truth) {
  return write_file_atomically(path, truth_to_json(truth));
}

Result<TabletTruth> parse_truth(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const double mm = mm_per_unit_of(root);
  TabletTruth truth;
  if (const auto mesh = root.find("mesh")) {
    truth.mesh = mesh->text();
  }
  if (const auto seed = root.find("seed")) {
    truth.seed = seed->unsigned_integer();
  }
  if (const auto size = root.find("size")) {
    truth.size_mm = mm * size->vector3();
  }
  if (const auto spacing = root.find("spacing_mm")) {
    truth.spacing_mm = spacing->number(0);
  }
  for (const JsonNode& node : root.at("wedges").items()) {
    truth.wedges.push_back(wedge_from(node, mm));
  }
  if (Status status = document->status("write the truth again with dubsar simulate tablet"); !status) {
    return std::unexpected(status.error());
  }
  return truth;
}

Result<TabletTruth> read_truth(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_truth(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
