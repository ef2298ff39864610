// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/rig_limits_json.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

/// Larger lengths are a slip of the keyboard.
constexpr double kMostMm = 1e6;

std::optional<Range> range_of(const JsonNode& node, const char* key, double scale, double most) {
  const auto found = node.find(key);
  if (!found) {
    return std::nullopt;
  }
  const std::vector<double> ends = found->numbers(2);
  const Range range{ends[0] * scale, ends[1] * scale};
  if (!(range.low <= range.high)) {
    found->complain("goes from more to less");
  }
  if (!(std::abs(range.low) <= most && std::abs(range.high) <= most)) {
    found->complain("is out of all reason");
  }
  return range;
}

OrderedJson pair_of(const Range& range, double scale) {
  return {range.low * scale, range.high * scale};
}

}  // namespace

Result<RigLimits> parse_rig_limits(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"unit", "turntable_deg", "tilt_deg", "arm", "hand_turns", "keep_out_margin"});
  const double mm = mm_per_unit_of(root);
  RigLimits limits;
  const double rad = rad_from_deg(1.0);
  limits.turntable_rad = range_of(root, "turntable_deg", rad, kMostTurnRad);
  limits.tilt_rad = range_of(root, "tilt_deg", rad, kMostTurnRad);
  if (const auto arm = root.find("arm")) {
    arm->only({"reach", "height", "standoff"});
    limits.reach_mm = range_of(*arm, "reach", mm, kMostMm);
    limits.height_mm = range_of(*arm, "height", mm, kMostMm);
    limits.standoff_mm = range_of(*arm, "standoff", mm, kMostMm);
  }
  if (const auto hands = root.find("hand_turns")) {
    limits.no_hand_turns = !hands->boolean();
  }
  if (const auto margin = root.find("keep_out_margin")) {
    limits.margin_mm = margin->number(0, kMostMm) * mm;
  }
  if (const Status status = document->status("see docs/formats/rig.md"); !status) {
    return std::unexpected(status.error());
  }
  return limits;
}

Result<RigLimits> read_rig_limits(const std::filesystem::path& file) {
  const Result<std::string> text = read_whole_file(file, kMaxJsonBytes);
  if (!text) {
    return std::unexpected(text.error());
  }
  return parse_rig_limits(*text, file.string());
}

std::string rig_limits_to_json(const RigLimits& limits) {
  const double deg = deg_from_rad(1.0);
  OrderedJson json{{"unit", "mm"}};
  if (limits.turntable_rad) {
    json["turntable_deg"] = pair_of(*limits.turntable_rad, deg);
  }
  if (limits.tilt_rad) {
    json["tilt_deg"] = pair_of(*limits.tilt_rad, deg);
  }
  OrderedJson arm;
  for (const auto& [key, range] :
       {std::pair{"reach", &limits.reach_mm}, std::pair{"height", &limits.height_mm},
        std::pair{"standoff", &limits.standoff_mm}}) {
    if (*range) {
      arm[key] = pair_of(**range, 1.0);
    }
  }
  if (!arm.is_null()) {
    json["arm"] = arm;
  }
  if (limits.no_hand_turns) {
    json["hand_turns"] = false;
  }
  if (limits.margin_mm) {
    json["keep_out_margin"] = *limits.margin_mm;
  }
  return text_of(json);
}

}  // namespace dubsar
