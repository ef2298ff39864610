// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/pins_json.h"

#include <set>

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

/// Pins stand beside a hand-sized tablet.
constexpr double kMaxTipDiameterMm = 50;
constexpr double kMinTipDiameterMm = 0.01;

std::vector<PinTip> tips_from(const JsonNode& node, double mm) {
  std::vector<PinTip> tips;
  std::set<int> labels;
  for (const JsonNode& item : node.items()) {
    PinTip tip;
    if (const auto label = item.find("label")) {
      tip.label = static_cast<int>(label->integer(-1, std::numeric_limits<int>::max()));
      if (tip.label >= 0 && !labels.insert(tip.label).second) {
        label->complain("stands twice in one scan");
      }
    }
    tip.position_mm = mm * item.at("position").vector3();
    tips.push_back(tip);
  }
  return tips;
}

}  // namespace

std::string pins_to_json(const PinSet& pins) {
  OrderedJson scans = OrderedJson::array();
  for (const auto& [id, tips] : pins.tips) {
    OrderedJson list = OrderedJson::array();
    for (const PinTip& tip : tips) {
      list.push_back({{"label", tip.label}, {"position", json_of(tip.position_mm)}});
    }
    scans.push_back({{"id", id}, {"tips", std::move(list)}});
  }
  OrderedJson root;
  root["tip_diameter_mm"] = pins.tip_diameter_mm;
  if (!pins.tips.empty()) {
    root["scans"] = std::move(scans);
  }
  return text_of(root);
}

Status write_pins(const std::filesystem::path& path, const PinSet& pins) {
  return write_file_atomically(path, pins_to_json(pins));
}

Result<PinSet> parse_pins(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  PinSet pins;
  pins.tip_diameter_mm = root.at("tip_diameter_mm").number(kMinTipDiameterMm, kMaxTipDiameterMm);
  if (const auto scans = root.find("scans")) {
    for (const JsonNode& scan : scans->items()) {
      const int id = static_cast<int>(scan.at("id").integer(0, std::numeric_limits<int>::max()));
      if (!pins.tips.emplace(id, tips_from(scan.at("tips"), mm_per_unit_of(root))).second) {
        scan.complain("has the id of an earlier scan");
      }
    }
  }
  if (Status status = document->status("give pins as docs/formats/pins.md has them"); !status) {
    return std::unexpected(status.error());
  }
  return pins;
}

Result<PinSet> read_pins(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_pins(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
