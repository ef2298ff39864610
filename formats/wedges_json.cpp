// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/wedges_json.h"

#include <algorithm>
#include <array>
#include <limits>

#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/file_label_reader.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/wedge_json.h"

namespace dubsar {

namespace {

const std::vector<std::string> kExits = {"surface", "extent"};

OrderedJson profile_json(const WedgeProfile& profile) {
  OrderedJson json;
  json["of"] = profile.side ? to_string(*profile.side) : "tablet";
  json["count"] = profile.count;
  if (profile.beyond_mesh > 0) {
    json["beyond_mesh"] = profile.beyond_mesh;
  }
  json["kinds"] = OrderedJson::object();
  for (std::size_t k = 0; k < kWedgeKinds.size(); ++k) {
    json["kinds"][std::string(kWedgeKinds[k])] = profile.kinds[k];
  }
  json["deciles"] = OrderedJson::object();
  for (std::size_t f = 0; f < kWedgeFeatures.size(); ++f) {
    json["deciles"][std::string(kWedgeFeatures[f])] = profile.quantiles[f];
  }
  return json;
}

/// Nothing of another version, which counted other kinds or features: it follows from the wedges anyway.
std::optional<WedgeProfile> profile_from(const JsonNode& node) {
  WedgeProfile profile;
  std::vector<std::string> words{"tablet"};
  for (int side = 0; side < kFaceCount; ++side) {
    words.emplace_back(to_string(static_cast<Face>(side)));
  }
  if (const std::size_t of = node.at("of").one_of(words); of > 0) {
    profile.side = static_cast<Face>(of - 1);
  }
  profile.count = static_cast<int>(node.at("count").integer(0, std::numeric_limits<int>::max()));
  if (const auto beyond = node.find("beyond_mesh")) {
    profile.beyond_mesh = static_cast<int>(beyond->integer(0, std::numeric_limits<int>::max()));
  }
  const JsonNode kinds = node.at("kinds");
  const JsonNode deciles = node.at("deciles");
  for (std::size_t k = 0; k < kWedgeKinds.size(); ++k) {
    const auto share = kinds.find(std::string(kWedgeKinds[k]).c_str());
    if (!share) {
      return std::nullopt;
    }
    profile.kinds[k] = share->number(0, 1 + 1e-9);
  }
  for (std::size_t f = 0; f < kWedgeFeatures.size(); ++f) {
    const auto values = deciles.find(std::string(kWedgeFeatures[f]).c_str());
    if (!values) {
      return std::nullopt;
    }
    std::ranges::copy(values->numbers(kProfileQuantiles), profile.quantiles[f].begin());
  }
  return profile;
}

}  // namespace

bool has_corrections(const WedgeFile& file, const std::vector<WedgeCorrection>& corrections) {
  return file.corrections == corrections.size() &&
         (file.corrections_xxh128.empty() || file.corrections_xxh128 == corrections_digest(corrections));
}

std::string wedges_to_json(const WedgeFile& file) {
  OrderedJson root;
  root["unit"] = "mm";
  if (!file.program.empty()) {
    root["program"] = file.program;
  }
  if (file.method > 0) {
    root["method"] = file.method;
  }
  for (const auto& [name, value] : file.label.words) {
    root["tablet"][label_value(name)] = label_value(value);
  }
  root["mesh"] = file.mesh;
  if (!file.unit_assumed.empty()) {
    root["unit_assumed"] = file.unit_assumed;
  }
  if (file.spacing_mm > 0) {
    root["spacing_mm"] = file.spacing_mm;
  }
  root["exit"] = kExits[static_cast<std::size_t>(file.exits)];
  if (file.text_from_model) {
    root["text_from_model"] = json_of(*file.text_from_model);
    root["text_certainty"] = file.text_certainty;
  }
  root["wedges"] = OrderedJson::array();
  for (const Wedge& wedge : file.wedges) {
    OrderedJson json = wedge_json(wedge);
    add_measures(wedge, &json);
    root["wedges"].push_back(std::move(json));
  }
  for (const KnownWedge& one : file.former) {
    OrderedJson json;
    json["id"] = one.id;
    json["depth_point"] = json_of(one.depth_point_mm);
    if (one.by_hand != ByHand::kNo) {
      json["by_hand"] = kByHandNames[static_cast<std::size_t>(one.by_hand)];
    }
    root["former"].push_back(std::move(json));
  }
  root["profiles"] = OrderedJson::array();
  for (const WedgeProfile& profile : file.profiles) {
    root["profiles"].push_back(profile_json(profile));
  }
  root["rejected"] = OrderedJson::array();
  for (const RejectedWedge& rejected : file.rejected) {
    OrderedJson json;
    json["reason"] = rejected.reason;
    json["depth_point"] = json_of(rejected.depth_point_mm);
    root["rejected"].push_back(std::move(json));
  }
  if (file.corrections > 0) {
    OrderedJson lost = OrderedJson::array();
    for (const LostCorrection& one : file.lost) {
      lost.push_back({{"number", one.index + 1}, {"reason", one.reason}});
    }
    root["corrections"]["asked_for"] = file.corrections;
    if (!file.corrections_xxh128.empty()) {
      root["corrections"]["xxh128"] = file.corrections_xxh128;
    }
    root["corrections"]["lost"] = std::move(lost);
  }
  root["timings_s"] = OrderedJson::object();
  for (const auto& [stage, seconds] : file.timings_s) {
    root["timings_s"][stage] = seconds;
  }
  return text_of(root);
}

Status write_wedges(const std::filesystem::path& path, const WedgeFile& file) {
  return write_file_atomically(path, wedges_to_json(file));
}

Result<WedgeFile> parse_wedges(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const double mm = mm_per_unit_of(root);
  WedgeFile file;
  if (const auto program = root.find("program"); program && program->is_text()) {
    file.program = program->text();
  }
  constexpr std::int64_t kMostMethods = std::numeric_limits<int>::max();
  if (const auto method = root.find("method"); method && method->is_whole_number(1, kMostMethods)) {
    file.method = static_cast<int>(method->integer(1, kMostMethods));
  }
  if (const auto tablet = root.find("tablet")) {
    file.label = label_in_object(*tablet);
  }
  if (const auto mesh = root.find("mesh")) {
    file.mesh = mesh->text();
  }
  if (const auto unit = root.find("unit_assumed")) {
    file.unit_assumed = unit->text();
  }
  if (const auto spacing = root.find("spacing_mm")) {
    constexpr double kWidestMm = 1e6;
    file.spacing_mm = spacing->number(0, kWidestMm);
  }
  if (const auto exits = root.find("exit")) {
    file.exits = static_cast<ExitDefinition>(exits->one_of(kExits));
  }
  if (const auto frame = root.find("text_from_model")) {
    file.text_from_model = frame->transform(mm);
    file.text_certainty = root.at("text_certainty").number(0, 1);
  }
  for (const JsonNode& node : root.at("wedges").items()) {
    file.wedges.push_back(wedge_from(node, mm));
    if (file.exits == ExitDefinition::kExtent) {  // earlier versions said those of the other definition
      file.wedges.back().sigma.forget_lengths();
    }
  }
  if (const auto former = root.find("former")) {
    static const std::vector<std::string> kNames(kByHandNames.begin(), kByHandNames.end());
    for (const JsonNode& node : former->items()) {
      KnownWedge one;
      one.id = static_cast<int>(node.at("id").integer(0, std::numeric_limits<int>::max()));
      one.depth_point_mm = mm * node.at("depth_point").vector3();
      if (const auto by_hand = node.find("by_hand")) {
        one.by_hand = static_cast<ByHand>(by_hand->one_of(kNames));
      }
      file.former.push_back(one);
    }
  }
  if (const auto profiles = root.find("profiles")) {
    for (const JsonNode& node : profiles->items()) {
      if (const auto profile = profile_from(node)) {
        file.profiles.push_back(*profile);
      }
    }
  }
  if (const auto rejected = root.find("rejected")) {
    for (const JsonNode& node : rejected->items()) {
      file.rejected.push_back({node.at("reason").text(), mm * node.at("depth_point").vector3()});
    }
  }
  if (const auto corrections = root.find("corrections")) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    file.corrections = static_cast<std::size_t>(corrections->at("asked_for").integer(0, kMost));
    if (const auto digest = corrections->find("xxh128")) {
      file.corrections_xxh128 = digest->text();
    }
    for (const JsonNode& node : corrections->at("lost").items()) {
      file.lost.push_back(
          {static_cast<std::size_t>(node.at("number").integer(1, kMost) - 1), node.at("reason").text()});
    }
  }
  if (Status status = document->status("write it again with dubsar analyze"); !status) {
    return std::unexpected(status.error());
  }
  return file;
}

Result<WedgeFile> read_wedges(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_wedges(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
