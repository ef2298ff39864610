// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/rig_json.h"

#include <cmath>

#include "core/rig_limits.h"
#include "core/units.h"
#include "formats/calibration_check_json.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

Range range(const JsonNode& node, double scale = 1.0) {
  const std::vector<double> ends = node.numbers(2);
  if (!(ends[0] <= ends[1])) {
    node.complain("goes from more to less");
  }
  return Range{ends[0] * scale, ends[1] * scale};
}

Range angles(const JsonNode& node, double scale) {
  const Range found = range(node, scale);
  if (!(std::abs(found.low) <= kMostTurnRad && std::abs(found.high) <= kMostTurnRad)) {
    node.complain("is out of all reason");
  }
  return found;
}

void read_tilt(const JsonNode& root, Rig& rig) {
  const auto exact = root.find("tilt_rad");
  const Range rounded = angles(root.at("tilt_deg"), rad_from_deg(1.0));
  const Range tilt = exact ? angles(*exact, 1.0) : rounded;
  rig.tilt_min_rad = tilt.low;
  rig.tilt_max_rad = tilt.high;
}

/// What sessions of before arms and limits do not have.
void read_motion(const JsonNode& root, Rig& rig) {
  if (const auto turntable = root.find("turntable_deg")) {
    rig.turntable_rad = angles(*turntable, rad_from_deg(1.0));
  }
  if (const auto arm = root.find("arm")) {
    rig.robot = RobotReach{arm->at("base").vector3(), range(arm->at("reach")), range(arm->at("height")),
                           range(arm->at("standoff"))};
  }
  if (const auto head = root.find("head")) {
    rig.head = HeadBox{head->at("low").vector3(), head->at("high").vector3()};
  }
  if (const auto margin = root.find("keep_out_margin")) {
    rig.keep_out_margin_mm = margin->number(0, 1e6);
  }
}

}  // namespace

std::string rig_to_json(const Rig& rig) {
  OrderedJson view{{"direction", json_of(rig.view.direction)}};
  if (rig.view.laser_mm) {
    view["laser"] = json_of(*rig.view.laser_mm);
  }
  if (rig.view.camera_mm) {
    view["camera"] = json_of(*rig.view.camera_mm);
  }
  view["motion_per_row"] = json_of(rig.view.motion_per_row_mm);
  OrderedJson json{{"unit", "mm"},
                   {"name", rig.name},
                   {"view", view},
                   {"spacing", rig.spacing_mm},
                   {"field", {rig.field_x_mm, rig.field_y_mm}},
                   {"depth_range", rig.depth_range_mm},
                   {"has_turntable", rig.has_turntable},
                   {"tilt_deg", {deg_from_rad(rig.tilt_min_rad), deg_from_rad(rig.tilt_max_rad)}},
                   // Exact, where degrees are rounded: planning again on a stored rig gives the same bytes.
                   {"tilt_rad", {rig.tilt_min_rad, rig.tilt_max_rad}},
                   {"hand_turns", rig.hand_turns},
                   {"support_height", rig.support_height_mm},
                   {"calibration", rig.calibration}};
  if (rig.has_turntable && !rig.turns_fully()) {
    json["turntable_deg"] = {deg_from_rad(rig.turntable_rad.low), deg_from_rad(rig.turntable_rad.high)};
  }
  if (rig.robot) {
    const auto pair = [](const Range& range) { return OrderedJson{range.low, range.high}; };
    json["arm"] = {{"base", json_of(rig.robot->base_mm)},
                   {"reach", pair(rig.robot->reach_mm)},
                   {"height", pair(rig.robot->height_mm)},
                   {"standoff", pair(rig.robot->standoff_mm)}};
  }
  if (rig.head) {
    json["head"] = {{"low", json_of(rig.head->low_mm)}, {"high", json_of(rig.head->high_mm)}};
  }
  json["keep_out_margin"] = rig.keep_out_margin_mm;
  if (rig.calibration_age_days) {
    json["calibration_age_days"] = *rig.calibration_age_days;
  }
  if (rig.calibration_check) {
    json["calibration_check"] = json_of(*rig.calibration_check);
  }
  return text_of(json);
}

Result<Rig> parse_rig(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  Rig rig;
  rig.name = root.at("name").text();
  const JsonNode view = root.at("view");
  rig.view.direction = view.at("direction").vector3();
  if (const auto laser = view.find("laser")) {
    rig.view.laser_mm = laser->vector3();
  }
  if (const auto camera = view.find("camera")) {
    rig.view.camera_mm = camera->vector3();
  }
  rig.view.motion_per_row_mm = view.at("motion_per_row").vector3();
  rig.spacing_mm = root.at("spacing").number(0, kMostRigSpacingMm);
  const std::vector<double> field = root.at("field").numbers(2);
  rig.field_x_mm = field[0];
  rig.field_y_mm = field[1];
  rig.depth_range_mm = root.at("depth_range").number(0, kMostDepthRangeMm);
  rig.has_turntable = root.at("has_turntable").boolean();
  read_tilt(root, rig);
  rig.hand_turns = root.at("hand_turns").boolean();
  rig.support_height_mm = root.at("support_height").number(-kMostSupportHeightMm, kMostSupportHeightMm);
  rig.calibration = root.at("calibration").text();
  if (const auto age = root.find("calibration_age_days")) {
    rig.calibration_age_days = age->number(0, kMostCalibrationAgeDays);
  }
  read_motion(root, rig);
  if (const auto check = root.find("calibration_check")) {
    rig.calibration_check = read_calibration_check(*check);
  }
  if (const Status status = document->status("scan again with the device, which writes it anew"); !status) {
    return std::unexpected(status.error());
  }
  return rig;
}

}  // namespace dubsar
