// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/calibration_json.h"

#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

OrderedJson quality_json(const CalibrationQuality& q) {
  return {{"board_views", q.board_views},         {"stripe_views", q.stripe_views},
          {"stage_positions", q.stage_positions}, {"corner_rms_px", q.corner_rms_px},
          {"corner_rms_um", q.corner_rms_um},     {"stripe_rms_px", q.stripe_rms_px},
          {"stripe_rms_um", q.stripe_rms_um},     {"stage_rms_um", q.stage_rms_um},
          {"focal_sigma_px", q.focal_sigma_px},   {"volume_sigma_um", q.volume_sigma_um},
          {"axis_sigma_rad", q.axis_sigma_rad},   {"left_out", q.left_out}};
}

CalibrationQuality read_quality(const JsonNode& node) {
  constexpr int kMost = 1'000'000;
  node.only({"board_views", "stripe_views", "stage_positions", "corner_rms_px", "corner_rms_um",
             "stripe_rms_px", "stripe_rms_um", "stage_rms_um", "focal_sigma_px", "volume_sigma_um",
             "axis_sigma_rad", "left_out"});
  const auto count = [&](const char* key) { return static_cast<int>(node.at(key).integer(0, kMost)); };
  const auto number = [&](const char* key) { return node.at(key).number(0, 1e9); };
  CalibrationQuality q;
  q.board_views = count("board_views");
  q.stripe_views = count("stripe_views");
  q.stage_positions = count("stage_positions");
  q.corner_rms_px = number("corner_rms_px");
  q.corner_rms_um = number("corner_rms_um");
  q.stripe_rms_px = number("stripe_rms_px");
  q.stripe_rms_um = number("stripe_rms_um");
  q.stage_rms_um = number("stage_rms_um");
  q.focal_sigma_px = number("focal_sigma_px");
  q.volume_sigma_um = number("volume_sigma_um");
  q.axis_sigma_rad = number("axis_sigma_rad");
  for (const JsonNode& item : node.at("left_out").items()) {
    q.left_out.push_back(item.text());
  }
  return q;
}

CameraModel read_camera(const JsonNode& node) {
  constexpr int kMostPixels = 1 << 16;
  node.only({"serial", "width", "height", "focal_px", "center_px", "distortion"});
  CameraModel camera;
  camera.width = static_cast<int>(node.at("width").integer(2, kMostPixels));
  camera.height = static_cast<int>(node.at("height").integer(2, kMostPixels));
  const std::vector<double> focal = node.at("focal_px").numbers(2);
  const std::vector<double> center = node.at("center_px").numbers(2);
  const std::vector<double> distortion = node.at("distortion").numbers(5);
  camera.fx_px = focal[0];
  camera.fy_px = focal[1];
  camera.cx_px = center[0];
  camera.cy_px = center[1];
  camera.k1 = distortion[0];
  camera.k2 = distortion[1];
  camera.p1 = distortion[2];
  camera.p2 = distortion[3];
  camera.k3 = distortion[4];
  return camera;
}

}  // namespace

const std::vector<std::string>& motion_words() {
  static const std::vector<std::string> words{"linear", "galvanometer", "turntable"};
  return words;
}

const char* motion_word(MotionKind kind) {
  return motion_words()[static_cast<std::size_t>(kind)].c_str();
}

std::string calibration_to_json(const RigCalibration& c) {
  OrderedJson json;
  json["unit"] = "mm";
  json["made_at"] = c.made_at;
  json["camera"] =
      OrderedJson{{"serial", c.camera_serial},
                  {"width", c.camera.width},
                  {"height", c.camera.height},
                  {"focal_px", {c.camera.fx_px, c.camera.fy_px}},
                  {"center_px", {c.camera.cx_px, c.camera.cy_px}},
                  {"distortion", {c.camera.k1, c.camera.k2, c.camera.p1, c.camera.p2, c.camera.k3}}};
  if (c.has_laser) {
    json["laser"] = OrderedJson{{"normal", json_of(c.laser.normal)}, {"distance", c.laser.distance_mm}};
    if (c.laser_source_mm) {
      json["laser"]["source"] = json_of(*c.laser_source_mm);
    }
  }
  if (c.has_motion) {
    json["stage"] =
        OrderedJson{{"motion", motion_word(c.motion.kind)}, {"direction", json_of(c.motion.direction)}};
    if (c.motion.kind != MotionKind::kLinear) {
      json["stage"]["axis_point"] = json_of(c.motion.axis_point_mm);
    }
  }
  json["working_distance"] = c.working_distance_mm;
  json["depth_range"] = c.depth_range_mm;
  if (c.temperature_c) {
    json["temperature_c"] = *c.temperature_c;
  }
  json["note"] = c.note;
  json["quality"] = quality_json(c.quality);
  return text_of(json);
}

Result<RigCalibration> parse_calibration(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"unit", "made_at", "camera", "laser", "stage", "working_distance", "depth_range",
             "temperature_c", "note", "quality"});
  RigCalibration c;
  if (const auto unit = root.find("unit"); unit && unit->text() != "mm") {
    unit->complain("is not mm");
  }
  c.made_at = root.at("made_at").text();
  c.camera = read_camera(root.at("camera"));
  c.camera_serial = root.at("camera").at("serial").text();
  const auto laser = root.find("laser");
  c.has_laser = laser.has_value();
  if (laser) {
    laser->only({"normal", "distance", "source"});
    c.laser.normal = laser->at("normal").vector3();
    c.laser.distance_mm = laser->at("distance").number(-1e6, 1e6);
    if (const auto source = laser->find("source")) {
      c.laser_source_mm = source->vector3();
    }
  }
  const auto stage = root.find("stage");
  c.has_motion = stage.has_value();
  if (stage) {
    stage->only({"motion", "direction", "axis_point"});
    c.motion.kind = static_cast<MotionKind>(stage->at("motion").one_of(motion_words()));
    c.motion.direction = stage->at("direction").vector3();
    if (c.motion.kind != MotionKind::kLinear) {
      c.motion.axis_point_mm = stage->at("axis_point").vector3();
    }
  }
  c.working_distance_mm = root.at("working_distance").number(0, 1e6);
  c.depth_range_mm = root.at("depth_range").number(0, 1e6);
  if (const auto temperature = root.find("temperature_c")) {
    c.temperature_c = temperature->number(-100, 200);
  }
  c.note = root.at("note").text();
  c.quality = read_quality(root.at("quality"));
  if (const Status status = document->status("calibrate the rig again"); !status) {
    return std::unexpected(status.error());
  }
  if (Status status = c.check(where); !status) {
    return std::unexpected(status.error());
  }
  return c;
}

}  // namespace dubsar
