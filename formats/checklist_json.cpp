// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/checklist_json.h"

#include <cmath>

#include "core/units.h"
#include "formats/calibration_check_json.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/sign_off_json.h"

namespace dubsar {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Infinite becomes null: so much of the surface was not sampled well at all.
OrderedJson spread_json(const Spread& spread, double per_unit) {
  const auto value = [&](double v) { return std::isfinite(v) ? OrderedJson(v * per_unit) : OrderedJson(); };
  OrderedJson json;
  json["median"] = value(spread.median);
  json["p95"] = value(spread.p95);
  return json;
}

Spread spread_from(const JsonNode& node, double per_unit) {
  const auto value = [&](const char* key) {
    const auto found = node.find(key);
    return found ? found->number(0) / per_unit : kInfinite;
  };
  return {value("median"), value("p95")};
}

OrderedJson sampling_json(const SamplingQuality& q) {
  OrderedJson json;
  json["places"] = q.places;
  json["spacing_um"] = spread_json(q.spacing_mm, 1000);
  json["share_within_25um"] = q.fine_share;
  json["single_scan_spacing_um"] = spread_json(q.single_spacing_mm, 1000);
  json["single_scan_share_within_25um"] = q.single_fine_share;
  json["incidence_deg"] = spread_json(q.incidence_rad, deg_from_rad(1.0));
  json["incidence_share_by_10deg"] = q.incidence_share;
  json["scans_share"] = q.scans_share;
  return json;
}

SamplingQuality sampling_from(const JsonNode& node) {
  SamplingQuality q;
  q.places = node.at("places").integer(0, std::int64_t{1} << 50U);
  q.spacing_mm = spread_from(node.at("spacing_um"), 1000);
  q.fine_share = node.at("share_within_25um").number(0, 1);
  q.single_spacing_mm = spread_from(node.at("single_scan_spacing_um"), 1000);
  q.single_fine_share = node.at("single_scan_share_within_25um").number(0, 1);
  q.incidence_rad = spread_from(node.at("incidence_deg"), deg_from_rad(1.0));
  const std::vector<double> angles = node.at("incidence_share_by_10deg").numbers(q.incidence_share.size());
  std::copy(angles.begin(), angles.end(), q.incidence_share.begin());
  const std::vector<double> scans = node.at("scans_share").numbers(q.scans_share.size());
  std::copy(scans.begin(), scans.end(), q.scans_share.begin());
  return q;
}

OrderedJson face_json(const FaceCoverage& face) {
  OrderedJson json;
  json["seen_mm2"] = face.seen_mm2;
  json["coverage"] = face.coverage();
  json["interpolated_mm2"] = face.interpolated_mm2;
  json["red_mm2"] = face.red_mm2;
  json["excused_mm2"] = face.excused_mm2;
  json["red_regions_mm2"] = face.red_regions_mm2;
  json["excused_regions_mm2"] = face.excused_regions_mm2;
  json["sampling"] = sampling_json(face.sampling);
  return json;
}

std::vector<double> sizes_from(const JsonNode& node) {
  std::vector<double> sizes;
  for (const JsonNode& size : node.items()) {
    sizes.push_back(size.number(0));
  }
  return sizes;
}

FaceCoverage face_from(const JsonNode& node) {
  FaceCoverage face;
  face.seen_mm2 = node.at("seen_mm2").number(0);
  face.red_mm2 = node.at("red_mm2").number(0);
  face.excused_mm2 = node.at("excused_mm2").number(0);
  // Earlier sessions end here.
  if (const auto interpolated = node.find("interpolated_mm2")) {
    face.interpolated_mm2 = interpolated->number(0);
    face.red_regions_mm2 = sizes_from(node.at("red_regions_mm2"));
    face.excused_regions_mm2 = sizes_from(node.at("excused_regions_mm2"));
    face.sampling = sampling_from(node.at("sampling"));
  }
  return face;
}

/// Absent where there are none.
std::vector<ScanWarning> lines_from(const JsonNode& root, const char* key) {
  std::vector<ScanWarning> out;
  if (const auto lines = root.find(key)) {
    for (const JsonNode& line : lines->items()) {
      out.push_back({static_cast<int>(line.at("scan").integer(0, std::numeric_limits<int>::max())),
                     line.at("text").text()});
    }
  }
  return out;
}

/// Likewise.
std::vector<int> ids_from(const JsonNode& root, const char* key) {
  std::vector<int> out;
  if (const auto ids = root.find(key)) {
    for (const JsonNode& id : ids->items()) {
      out.push_back(static_cast<int>(id.integer(0, std::numeric_limits<int>::max())));
    }
  }
  return out;
}

}  // namespace

OrderedJson checklist_json(const Checklist& list) {
  OrderedJson root;
  root["conclusive"] = list.conclusive;
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    root["faces"][to_string(static_cast<Face>(face))] = face_json(list.faces[face]);
  }
  root["sampling"] = sampling_json(list.sampling);
  root["strays"] = list.strays;
  root["scans_registered"] = list.scans_registered;
  root["scans_unsure"] = list.scans_unsure;
  root["scans_failed"] = list.scans_failed;
  if (!list.scans_lost.empty()) {
    root["scans_lost"] = list.scans_lost;
  }
  if (!list.scans_unplaced.empty()) {
    root["scans_unplaced"] = list.scans_unplaced;
  }
  if (list.worst_sigma_scan >= 0) {
    root["worst_sigma_mm"] = list.worst_sigma_mm;
    root["worst_sigma_scan"] = list.worst_sigma_scan;
  }
  const auto add_lines = [&](const char* key, const std::vector<ScanWarning>& lines) {
    for (const ScanWarning& line : lines) {
      root[key].push_back({{"scan", line.scan}, {"text", line.text}});
    }
  };
  add_lines("warnings", list.warnings);
  add_lines("remarks", list.remarks);
  root["calibration"] = list.calibration;
  if (list.calibration_age_days) {
    root["calibration_age_days"] = *list.calibration_age_days;
  }
  if (list.calibration_check) {
    root["calibration_check"] = json_of(*list.calibration_check);
  }
  root["disk_free_gib"] = list.disk_free_gib;
  root["store_whole"] = list.store_whole;
  root["store_checked"] = list.store_checked;
  root["store_files"] = list.store_files;
  root["sign_off"] = list.sign_off ? sign_off_json(*list.sign_off) : OrderedJson();
  return root;
}

std::string checklist_to_json(const Checklist& checklist) {
  return text_of(checklist_json(checklist));
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
  Checklist list;
  list.conclusive = root.at("conclusive").boolean();
  const JsonNode faces = root.at("faces");
  for (std::size_t face = 0; face < kFaceCount; ++face) {
    list.faces[face] = face_from(faces.at(to_string(static_cast<Face>(face))));
  }
  if (const auto sampling = root.find("sampling")) {
    list.sampling = sampling_from(*sampling);
    list.strays = count("strays");
    if (const auto checked = root.find("store_checked")) {
      list.store_checked = checked->text();
    }
    list.store_files = count("store_files");
  }
  list.scans_registered = count("scans_registered");
  list.scans_unsure = count("scans_unsure");
  list.scans_failed = count("scans_failed");
  list.scans_lost = ids_from(root, "scans_lost");
  list.scans_unplaced = ids_from(root, "scans_unplaced");
  if (const auto sigma = root.find("worst_sigma_mm")) {
    list.worst_sigma_mm = sigma->number(0);
    list.worst_sigma_scan = count("worst_sigma_scan");
  }
  list.warnings = lines_from(root, "warnings");
  list.remarks = lines_from(root, "remarks");
  list.calibration = root.at("calibration").text();
  if (const auto age = root.find("calibration_age_days")) {
    list.calibration_age_days = age->number();
  }
  if (const auto check = root.find("calibration_check")) {
    list.calibration_check = read_calibration_check(*check);
  }
  list.disk_free_gib = root.at("disk_free_gib").number(0);
  list.store_whole = root.at("store_whole").boolean();
  if (Status status = document->status("write the checklist again"); !status) {
    return std::unexpected(status.error());
  }
  return list;
}

}  // namespace dubsar
