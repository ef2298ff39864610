// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/rig_toml.h"

#include <array>
#include <cmath>

#include "core/units.h"
#include "formats/toml_document.h"

namespace dubsar {

namespace {

constexpr double kMostTravel = 1e5;
constexpr int kMostRows = 100'000;
constexpr int kMostPixels = 65'536;

/// Where the scan begins and ends, in mm or in degrees.
void read_scan(const JsonNode& scan, RigFile& rig) {
  scan.only({"from_mm", "to_mm", "step_mm", "speed_mm_s", "from_deg", "to_deg", "step_deg", "speed_deg_s",
             "continuous", "ambient", "laser_power"});
  const bool degrees = scan.find("step_deg").has_value();
  for (const char* other : degrees ? std::array{"from_mm", "to_mm", "step_mm", "speed_mm_s"}
                                   : std::array{"from_deg", "to_deg", "step_deg", "speed_deg_s"}) {
    if (const auto both = scan.find(other)) {
      both->complain(degrees ? "stands beside step_deg: a scan moves or turns"
                             : "needs step_deg: without it the scan moves");
    }
  }
  const double unit = degrees ? rad_from_deg(1) : 1;
  const double from = scan.at(degrees ? "from_deg" : "from_mm").number(-kMostTravel, kMostTravel) * unit;
  const double to = scan.at(degrees ? "to_deg" : "to_mm").number(-kMostTravel, kMostTravel) * unit;
  rig.step = scan.at(degrees ? "step_deg" : "step_mm").number(1e-6, kMostTravel) * unit;
  rig.start = from;
  rig.turns = degrees;
  const double rows = std::floor((to - from) / rig.step + 1e-6) + 1;
  if (!scan.failed() && !(rows >= 2 && rows <= kMostRows)) {
    scan.complain("has fewer than 2 rows or more than 100000: it goes up from `from` to `to`");
    return;
  }
  rig.rows = scan.failed() ? 0 : static_cast<int>(rows);
  if (const auto speed = scan.find(degrees ? "speed_deg_s" : "speed_mm_s")) {
    rig.speed = speed->number(1e-6, kMostTravel) * unit;
  }
  if (const auto continuous = scan.find("continuous")) {
    rig.continuous = continuous->boolean();
    rig.ambient = !rig.continuous;
  }
  if (const auto ambient = scan.find("ambient")) {
    rig.ambient = ambient->boolean();
    if (rig.ambient && rig.continuous) {
      ambient->complain("cannot be had of a continuous scan: nothing stands still for a second frame");
    }
  }
  if (const auto power = scan.find("laser_power")) {
    rig.laser_power = power->number(0, 1);
    if (rig.laser_power == 0) {
      power->complain("is 0: nothing would be seen");
    }
  }
}

PictureRegion read_region(const JsonNode& node) {
  if (node.size() != 4) {
    node.complain("is not x, y, width and height of a part of the picture");
    return {};
  }
  const auto pixels = [&](std::size_t k, int least) {
    return static_cast<int>(node.item(k).integer(least, kMostPixels));
  };
  return {pixels(0, 0), pixels(1, 0), pixels(2, 16), pixels(3, 16)};
}

/// How a stage moves a range camera.
void read_motion(const JsonNode& node, RigFile& rig) {
  node.only({"kind", "direction", "point_mm"});
  RigMotion motion;
  motion.kind =
      node.at("kind").one_of({"linear", "turntable"}) == 0 ? MotionKind::kLinear : MotionKind::kTurntable;
  motion.direction = node.at("direction").vector3();
  if (!node.failed() && !(motion.direction.norm() > 1e-3 && motion.direction.norm() < 1e3)) {
    node.complain("has a direction of no length");
  }
  if (motion.kind == MotionKind::kTurntable) {
    motion.direction.normalize();
    motion.axis_point_mm = node.at("point_mm").vector3();
  }
  rig.motion = motion;
}

std::string setting_text(const JsonNode& pair) {
  if (pair.size() != 2) {
    pair.complain("is no pair of a name and a value");
    return {};
  }
  return pair.item(1).text();
}

}  // namespace

Result<RigFile> parse_rig_file(std::string_view toml, const std::string& where) {
  const Result<JsonDocument> document = parse_toml(toml, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"name", "camera", "stage", "calibration", "motion", "camera_settings", "region_px", "axis",
             "laser", "scan", "stripe", "hand_turns", "support_height_mm", "head"});
  RigFile rig;
  rig.name = root.at("name").text();
  rig.camera = root.at("camera").text();
  rig.stage = root.at("stage").text();
  if (const auto motion = root.find("motion")) {
    if (root.find("calibration")) {
      motion->complain("is known from the calibration already: one of the two is enough");
    }
    read_motion(*motion, rig);
  } else {
    rig.calibration = root.at("calibration").text();
  }
  if (const auto settings = root.find("camera_settings")) {
    for (const JsonNode& pair : settings->items()) {
      rig.camera_settings.emplace_back(pair.item(0).text(), setting_text(pair));
    }
  }
  if (const auto region = root.find("region_px")) {
    rig.region = read_region(*region);
    if (rig.motion) {
      region->complain("is for a rig with a calibration: a range camera has it among camera_settings");
    }
  }
  if (const auto axis = root.find("axis")) {
    rig.axis = static_cast<int>(axis->integer(0, 7));
  }
  if (const auto laser = root.find("laser")) {
    rig.laser = static_cast<int>(laser->integer(0, 7));
  }
  read_scan(root.at("scan"), rig);
  if (const auto stripe = root.find("stripe")) {
    stripe->only({"sigma_px", "method", "runs"});
    if (const auto sigma = stripe->find("sigma_px")) {
      rig.stripe_sigma_px = sigma->number(0.3, 6);
    }
    if (const auto method = stripe->find("method")) {
      const std::vector<std::string> words{"adaptive", "centroid", "gaussian", "steger"};
      rig.stripe_method = words[method->one_of(words)];
    }
    if (const auto runs = stripe->find("runs")) {
      rig.stripe_per_row = runs->one_of({"across", "down"}) == 1;
    }
  }
  if (const auto turns = root.find("hand_turns")) {
    rig.hand_turns = turns->boolean();
  }
  if (const auto support = root.find("support_height_mm")) {
    rig.support_height_mm = support->number(-kMostTravel, kMostTravel);
  }
  if (const auto head = root.find("head")) {
    head->only({"low_mm", "high_mm"});
    rig.head = HeadBox{head->at("low_mm").vector3(), head->at("high_mm").vector3()};
    if ((rig.head->high_mm.array() < rig.head->low_mm.array()).any()) {
      head->complain("goes from more to less");
    }
  }
  if (const Status status = document->status("see docs/formats/rig_toml.md"); !status) {
    return std::unexpected(status.error());
  }
  return rig;
}

}  // namespace dubsar
