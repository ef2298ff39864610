// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/calibration_set.h"

#include <filesystem>

#include "core/number_text.h"
#include "core/units.h"
#include "core/utf8.h"
#include "formats/calibration_json.h"
#include "formats/toml_document.h"

namespace dubsar {

namespace {

constexpr double kMostTravel = 1e5;

std::string file_name(const JsonNode& node) {
  std::string name = node.text();
  const std::filesystem::path path(name);
  bool outside = path.is_absolute() || name.empty() || name.find('\0') != std::string::npos;
  for (const std::filesystem::path& part : path) {
    outside = outside || part == "..";
  }
  if (outside) {
    node.complain("is no file name inside the folder");
  }
  return name;
}

std::string quoted(const std::string& text) {
  std::string out(1, '"');
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') {
      out += '\\';
    }
    out += c;
  }
  out += '"';
  return out;
}

}  // namespace

Result<CalibrationSet> parse_calibration_set(std::string_view toml, const std::string& where) {
  const Result<JsonDocument> document = parse_toml(toml, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"board", "plate_margin_mm", "motion", "camera_serial", "depth_range_mm", "temperature_c", "note",
             "stripe_sigma_px", "stripe_runs", "pose", "stage"});
  CalibrationSet set;
  set.board = root.at("board").text();
  if (const auto margin = root.find("plate_margin_mm")) {
    set.plate_margin_mm = margin->number(0, 1000);
  }
  if (const auto motion = root.find("motion")) {
    set.motion = static_cast<MotionKind>(motion->one_of(motion_words()));
  }
  if (const auto serial = root.find("camera_serial")) {
    set.camera_serial = serial->text();
  }
  if (const auto range = root.find("depth_range_mm")) {
    set.depth_range_mm = range->number(0.1, 1e4);
  }
  if (const auto temperature = root.find("temperature_c")) {
    set.temperature_c = temperature->number(-100, 200);
  }
  if (const auto note = root.find("note")) {
    set.note = note->text();
  }
  if (const auto sigma = root.find("stripe_sigma_px")) {
    set.stripe_sigma_px = sigma->number(0.3, 6);
  }
  if (const auto runs = root.find("stripe_runs")) {
    set.stripe_per_row = runs->one_of({"across", "down"}) == 1;
  }
  if (const auto poses = root.find("pose")) {
    for (const JsonNode& node : poses->items()) {
      node.only({"board", "laser", "dark", "mirror_deg"});
      CalibrationSet::Pose pose;
      pose.board = file_name(node.at("board"));
      if (const auto laser = node.find("laser")) {
        pose.laser = file_name(*laser);
      }
      if (const auto dark = node.find("dark")) {
        pose.dark = file_name(*dark);
      }
      if (const auto mirror = node.find("mirror_deg")) {
        pose.mirror_rad = rad_from_deg(mirror->number(-360, 360));
      }
      set.poses.push_back(std::move(pose));
    }
  }
  if (const auto stops = root.find("stage")) {
    for (const JsonNode& node : stops->items()) {
      node.only({"board", "fixed", "position_mm", "position_deg"});
      CalibrationSet::Stop stop;
      stop.board = file_name(node.at("board"));
      const auto fixed = node.find("fixed");
      stop.fixed = fixed ? fixed->text() : std::string("stage");
      if (const auto degrees = node.find("position_deg")) {
        stop.position = rad_from_deg(degrees->number(-kMostTravel, kMostTravel));
      } else {
        stop.position = node.at("position_mm").number(-kMostTravel, kMostTravel);
      }
      if (node.find("position_deg").has_value() != (set.motion == MotionKind::kTurntable)) {
        node.complain("needs position_mm on a linear stage, position_deg on a turntable");
      }
      set.stops.push_back(std::move(stop));
    }
  }
  if (set.poses.empty() && set.stops.empty()) {
    root.complain("names no pose of the board");
  }
  if (const Status status = document->status("see docs/formats/calibration.md"); !status) {
    return std::unexpected(status.error());
  }
  return set;
}

std::string calibration_set_to_toml(const CalibrationSet& set) {
  std::string out;
  const auto line = [&](const char* key, const std::string& value) {
    out.append(key).append(" = ").append(value).append(1, '\n');
  };
  line("board", quoted(set.board));
  line("plate_margin_mm", number_text(set.plate_margin_mm));
  if (set.motion) {
    line("motion", quoted(motion_word(*set.motion)));
  }
  line("camera_serial", quoted(set.camera_serial));
  line("depth_range_mm", number_text(set.depth_range_mm));
  if (set.temperature_c) {
    line("temperature_c", number_text(*set.temperature_c));
  }
  line("note", quoted(set.note));
  line("stripe_sigma_px", number_text(set.stripe_sigma_px));
  line("stripe_runs", quoted(set.stripe_per_row ? "down" : "across"));
  for (const CalibrationSet::Pose& pose : set.poses) {
    out += "\n[[pose]]\n";
    line("board", quoted(pose.board));
    if (!pose.laser.empty()) {
      line("laser", quoted(pose.laser));
    }
    if (!pose.dark.empty()) {
      line("dark", quoted(pose.dark));
    }
    if (pose.mirror_rad != 0) {
      line("mirror_deg", number_text(deg_from_rad(pose.mirror_rad)));
    }
  }
  for (const CalibrationSet::Stop& stop : set.stops) {
    out += "\n[[stage]]\n";
    line("board", quoted(stop.board));
    line("fixed", quoted(stop.fixed));
    const bool turns = set.motion == MotionKind::kTurntable;
    line(turns ? "position_deg" : "position_mm",
         number_text(turns ? deg_from_rad(stop.position) : stop.position));
  }
  return out;
}

}  // namespace dubsar
