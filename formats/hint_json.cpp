// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/hint_json.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/rigid_matrix.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

/// Numbers that stand apart by commas or white space; nothing when anything else is among them.
std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> out;
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  bool comma = true;  // a comma must follow a number, and a number a comma or a blank
  std::size_t at = 0;
  while (at < text.size()) {
    if (blank(text[at])) {
      ++at;
    } else if (text[at] == ',') {
      if (comma) {
        return std::nullopt;
      }
      comma = true;
      ++at;
    } else {
      double value = 0;
      const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
      if (error != std::errc() || !std::isfinite(value)) {
        return std::nullopt;
      }
      at = static_cast<std::size_t>(end - text.data());
      if (at < text.size() && !blank(text[at]) && text[at] != ',') {
        return std::nullopt;
      }
      comma = false;
      out.push_back(value);
    }
  }
  return comma ? std::nullopt : std::optional(std::move(out));
}

}  // namespace

std::string hint_to_json(const PoseHint& hint) {
  OrderedJson root;
  root["unit"] = "mm";
  root["on"] = hint.on;
  if (hint.on_from_scanner) {
    root["on_from_scanner"] = json_of(*hint.on_from_scanner);
  } else {
    OrderedJson points = OrderedJson::array();
    for (const PointPair& pair : hint.points) {
      points.push_back({{"point", json_of(pair.point_mm)}, {"on_point", json_of(pair.on_point_mm)}});
    }
    root["points"] = std::move(points);
  }
  return root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

Result<HintFile> parse_hint(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const double mm = mm_per_unit_of(root);
  HintFile file;
  if (const auto on = root.find("on")) {
    file.hint.on = static_cast<int>(on->integer(0, std::numeric_limits<int>::max()));
  }
  int said = 0;
  if (const auto points = root.find("points")) {
    ++said;
    for (const JsonNode& pair : points->items()) {
      file.hint.points.push_back({mm * pair.at("point").vector3(), mm * pair.at("on_point").vector3()});
    }
  }
  if (const auto pose = root.find("on_from_scanner")) {
    ++said;
    file.hint.on_from_scanner = pose->transform(mm);
  }
  if (const auto pose = root.find("model_from_scanner")) {
    ++said;
    file.model_from_scanner = pose->transform(mm);
  }
  if (said != 1) {
    root.complain("must say one of points, on_from_scanner and model_from_scanner");
  }
  if (Status status = document->status("give a hint as docs/formats/hints.md has it"); !status) {
    return std::unexpected(status.error());
  }
  return file;
}

Result<HintFile> read_hint(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_hint(*text, path.string()) : std::unexpected(text.error());
}

Result<PointPair> parse_point_pair(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals != std::string_view::npos) {
    const auto here = numbers_in(text.substr(0, equals));
    const auto there = numbers_in(text.substr(equals + 1));
    if (here && there && here->size() == 3 && there->size() == 3) {
      return PointPair{{(*here)[0], (*here)[1], (*here)[2]}, {(*there)[0], (*there)[1], (*there)[2]}};
    }
  }
  return fail(ErrorKind::kUsage, "this is no point pair", std::string(text),
              "give x,y,z=x,y,z: the point in the scan, then the same point in the other");
}

Result<RigidTransform> parse_pose_numbers(std::string_view text, const std::string& where) {
  const auto numbers = numbers_in(text);
  if (!numbers || numbers->size() != 16) {
    return bad_input(where, "a pose is 16 numbers, row by row", "the last four are 0 0 0 1");
  }
  const std::optional<RigidTransform> pose = rigid_from_row_major(std::span(*numbers).first<16>());
  if (!pose) {
    return bad_input(where, "the pose is not a rigid transform",
                     "its turn must be right-handed and without scale, and the last row 0 0 0 1");
  }
  return pose->orthonormalised();
}

}  // namespace dubsar
