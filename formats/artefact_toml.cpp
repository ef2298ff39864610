// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/artefact_toml.h"

#include <algorithm>
#include <vector>

#include "formats/toml_document.h"

namespace dubsar {

Result<Artefact> parse_artefact(std::string_view toml, const std::string& where) {
  const Result<JsonDocument> document = parse_toml(toml, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  constexpr double kMostMm = 1000;
  constexpr double kMostUm = 1e6;
  constexpr std::size_t kMostBalls = 6;
  const JsonNode root = document->root();
  root.only({"name", "certificate", "ball", "plane", "plane_mm", "limit"});
  Artefact out;
  out.name = root.at("name").text();
  out.certificate = root.at("certificate").text();
  if (const auto balls = root.find("ball")) {
    for (const JsonNode& node : balls->items()) {
      node.only({"diameter_mm", "center_mm"});
      out.balls.push_back({node.at("diameter_mm").number(0.1, kMostMm), node.at("center_mm").vector3()});
    }
    if (out.balls.size() > kMostBalls) {
      balls->complain("holds more than six balls");
    }
  }
  if (const auto plane = root.find("plane")) {
    out.has_plane = plane->boolean();
  }
  if (const auto size = root.find("plane_mm")) {
    const std::vector<double> sides = size->numbers(2);
    if (sides.size() == 2 && std::min(sides[0], sides[1]) > 0 && std::max(sides[0], sides[1]) <= kMostMm) {
      out.plane_mm = {std::max(sides[0], sides[1]), std::min(sides[0], sides[1])};
    } else {
      size->complain("is no size of a plane");
    }
    out.has_plane = true;
  }
  const JsonNode limit = root.at("limit");
  limit.only({"form_um", "size_um", "spacing_um", "flatness_um"});
  const auto micrometres = [&](const char* key, bool needed) {
    return needed ? 1e-3 * limit.at(key).number(0.001, kMostUm) : 0.0;
  };
  out.form_limit_mm = micrometres("form_um", !out.balls.empty());
  out.size_limit_mm = micrometres("size_um", !out.balls.empty());
  out.spacing_limit_mm = micrometres("spacing_um", out.balls.size() > 1);
  out.flatness_limit_mm = micrometres("flatness_um", out.has_plane);
  if (out.balls.empty() && !out.has_plane) {
    root.complain("names neither a ball nor a plane");
  }
  for (std::size_t i = 0; i < out.balls.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if ((out.balls[i].center_mm - out.balls[k].center_mm).norm() <
          0.5 * (out.balls[i].diameter_mm + out.balls[k].diameter_mm)) {
        root.complain("has balls that overlap");
      }
    }
  }
  if (const Status status = document->status("see docs/formats/artefact.md"); !status) {
    return std::unexpected(status.error());
  }
  return out;
}

}  // namespace dubsar
