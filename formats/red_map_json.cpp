// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/red_map_json.h"

#include <array>

#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

constexpr std::array<Excuse, 2> kExcuses{Excuse::kUnreachable, Excuse::kUnneeded};

OrderedJson scan_json(const RedScan& scan) {
  OrderedJson json;
  json["id"] = scan.id;
  json["samples"] = scan.samples;
  json["potentially_sparse"] = scan.potentially_sparse;
  json["sparse"] = scan.sparse;
  json["cleared"] = scan.cleared;
  json["excused"] = scan.excused;
  return json;
}

OrderedJson region_json(const RedRegion& region) {
  OrderedJson json;
  json["face"] = to_string(region.face);
  json["center"] = json_of(region.center_mm);
  json["normal"] = json_of(region.normal);
  json["area_mm2"] = region.area_mm2;
  json["state"] = region.state == RegionState::kRed ? "red" : "excused";
  if (region.excuse != Excuse::kNone) {
    json["excuse"] = region.excuse == Excuse::kUnreachable ? "unreachable" : "unneeded";
  }
  if (region.excuse != Excuse::kNone || !region.reason.empty()) {
    json["reason"] = region.reason;
  }
  return json;
}

OrderedJson view_json(const NextView& view) {
  OrderedJson json;
  json["model_from_scanner"] = json_of(view.model_from_scanner);
  json["predicted_cleared_mm2"] = view.predicted_cleared_mm2;
  json["say"] = view.say;
  if (view.placement) {
    OrderedJson placement;
    placement["turntable_deg"] = deg_from_rad(view.placement->turntable_rad);
    placement["tilt_deg"] = deg_from_rad(view.placement->tilt_rad);
    if (view.placement->hand_turn) {
      placement["hand_turn"] = json_of(*view.placement->hand_turn);
    }
    if (view.placement->free_pose) {
      placement["stage_from_scanner"] = json_of(*view.placement->free_pose);
    }
    json["placement"] = std::move(placement);
  }
  return json;
}

RedScan scan_from(const JsonNode& node) {
  constexpr std::int64_t kMaxCount = std::int64_t{1} << 50U;
  RedScan scan;
  scan.id = static_cast<int>(node.at("id").integer(0, std::numeric_limits<int>::max()));
  scan.samples = node.at("samples").integer(0, kMaxCount);
  scan.potentially_sparse = node.at("potentially_sparse").integer(0, kMaxCount);
  scan.sparse = node.at("sparse").integer(0, kMaxCount);
  scan.cleared = node.at("cleared").integer(0, kMaxCount);
  scan.excused = node.at("excused").integer(0, kMaxCount);
  return scan;
}

ScanCopy copy_from(const JsonNode& node) {
  constexpr int kMostId = std::numeric_limits<int>::max();
  return {static_cast<int>(node.at("id").integer(0, kMostId)),
          static_cast<int>(node.at("of").integer(0, kMostId))};
}

GroupApart group_from(const JsonNode& node) {
  GroupApart group;
  for (const JsonNode& id : node.at("scans").items()) {
    group.ids.push_back(static_cast<int>(id.integer(0, std::numeric_limits<int>::max())));
  }
  group.say = node.at("say").text();
  return group;
}

RedRegion region_from(const JsonNode& node) {
  RedRegion region;
  region.face = static_cast<Face>(node.at("face").one_of(face_names()));
  region.center_mm = node.at("center").vector3();
  if (const auto normal = node.find("normal")) {
    region.normal = normal->vector3();
  }
  region.area_mm2 = node.at("area_mm2").number(0);
  region.state = node.at("state").one_of({"red", "excused"}) == 0 ? RegionState::kRed : RegionState::kExcused;
  if (const auto excuse = node.find("excuse")) {
    region.excuse = kExcuses[excuse->one_of({"unreachable", "unneeded"})];
  } else if (region.state == RegionState::kExcused) {
    node.complain("is excused but has no excuse");
  }
  if (const auto reason = node.find("reason")) {
    region.reason = reason->text();
  }
  return region;
}

NextView view_from(const JsonNode& node) {
  NextView view;
  view.model_from_scanner = node.at("model_from_scanner").transform();
  view.predicted_cleared_mm2 = node.at("predicted_cleared_mm2").number();
  view.say = node.at("say").text();
  if (const auto placement = node.find("placement")) {
    view.placement = Placement{};
    view.placement->turntable_rad = rad_from_deg(placement->at("turntable_deg").number());
    view.placement->tilt_rad = rad_from_deg(placement->at("tilt_deg").number());
    if (const auto turn = placement->find("hand_turn")) {
      view.placement->hand_turn = turn->transform();
    }
    if (const auto pose = placement->find("stage_from_scanner")) {
      view.placement->free_pose = pose->transform();
    }
  }
  return view;
}

}  // namespace

OrderedJson apart_json(const std::vector<GroupApart>& groups) {
  OrderedJson json = OrderedJson::array();
  for (const GroupApart& group : groups) {
    json.push_back({{"scans", group.ids}, {"say", group.say}});
  }
  return json;
}

std::string red_map_to_json(const RedMap& map) {
  OrderedJson root;
  root["conclusive"] = map.conclusive;
  root["scans"] = OrderedJson::array();
  for (const RedScan& scan : map.scans) {
    root["scans"].push_back(scan_json(scan));
  }
  for (const ScanCopy& copy : map.copies) {
    root["copies"].push_back({{"id", copy.id}, {"of", copy.of_id}});
  }
  root["regions"] = OrderedJson::array();
  for (const RedRegion& region : map.regions) {
    root["regions"].push_back(region_json(region));
  }
  root["next"] = OrderedJson::array();
  for (const NextView& view : map.next) {
    root["next"].push_back(view_json(view));
  }
  if (!map.apart.empty()) {
    root["groups_apart"] = apart_json(map.apart);
  }
  return text_of(root);
}

Status write_red_map(const std::filesystem::path& path, const RedMap& map) {
  return write_file_atomically(path, red_map_to_json(map));
}

Result<RedMap> parse_red_map(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  RedMap map;
  map.conclusive = root.at("conclusive").boolean();
  for (const JsonNode& node : root.at("scans").items()) {
    map.scans.push_back(scan_from(node));
  }
  if (const auto copies = root.find("copies")) {
    for (const JsonNode& node : copies->items()) {
      map.copies.push_back(copy_from(node));
    }
  }
  for (const JsonNode& node : root.at("regions").items()) {
    map.regions.push_back(region_from(node));
  }
  for (const JsonNode& node : root.at("next").items()) {
    map.next.push_back(view_from(node));
  }
  if (const auto apart = root.find("groups_apart")) {
    for (const JsonNode& node : apart->items()) {
      map.apart.push_back(group_from(node));
    }
  }
  if (Status status = document->status("give a red map as docs/formats/red_map.md has it"); !status) {
    return std::unexpected(status.error());
  }
  return map;
}

}  // namespace dubsar
