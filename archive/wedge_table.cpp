// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/wedge_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "core/units.h"

namespace dubsar {

namespace {

struct Column {
  std::string name;
  std::function<std::string(const Wedge&)> value;
};

std::string number(double value, int digits = 6) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : std::string();
}
/// A mesh may lie metres from the origin of its numbers.
constexpr int kPlaceDigits = 9;

using Three = std::array<double, 3>;

/// Spreadsheets run a cell that begins so as a formula, whoever wrote it: behind an apostrophe it is a text
/// (OWASP, "CSV injection"). Numbers do not come here.
std::string no_formula(std::string text) {
  const std::size_t first = text.find_first_not_of(' ');  // before which some of them pass over blanks
  if (first != std::string::npos && std::string_view("=+-@").contains(text[first])) {
    text.insert(text.begin(), '\'');
  }
  return text;
}

/// RFC 4180, 2.6 and 2.7: what holds a comma or a quote stands in quotes, and a quote is doubled.
std::string cell_of(const std::string& text) {
  const std::string line = no_formula(label_value(text));
  if (line.find_first_of(",\"") == std::string::npos) {
    return line;
  }
  std::string quoted = "\"";
  for (const char c : line) {
    quoted.append(c == '"' ? "\"\"" : std::string(1, c));
  }
  return quoted + "\"";
}

/// The same on every line: what the wedges are of.
void add_label(const FileLabel& label, std::vector<Column>* columns) {
  const auto collection =
      std::ranges::find(label.words, "Collection", &decltype(label.words)::value_type::first);
  const std::pair<const char*, std::string> said[] = {
      {"tablet", label.name},
      {"collection", collection == label.words.end() ? std::string() : collection->second},
      {"rights", label.rights},
      {"simulated", label.empty()     ? ""
                    : label.simulated ? "yes"
                                      : "no"}};
  for (const auto& [name, value] : said) {
    columns->push_back({name, [cell = cell_of(value)](const Wedge&) { return cell; }});
  }
}

std::vector<Column> columns(const FileLabel& label) {
  std::vector<Column> all;
  const auto text = [&](std::string name, std::function<std::string(const Wedge&)> value) {
    all.push_back({std::move(name), std::move(value)});
  };
  const auto plain = [&](std::string name, std::function<double(const Wedge&)> value) {
    text(std::move(name), [value = std::move(value)](const Wedge& w) { return number(value(w)); });
  };
  const auto point = [&](const std::string& name, const std::function<Eigen::Vector3d(const Wedge&)>& value) {
    for (int axis = 0; axis < 3; ++axis) {
      text(name + "_" + "xyz"[axis] + "_mm",
           [value, axis](const Wedge& w) { return number(value(w)[axis], kPlaceDigits); });
    }
  };
  const auto normal = [&](const std::string& name,
                          const std::function<Eigen::Vector3d(const Wedge&)>& value) {
    for (int axis = 0; axis < 3; ++axis) {
      plain(name + "_" + "xyz"[axis], [value, axis](const Wedge& w) { return value(w)[axis]; });
    }
  };
  const auto three = [&](const std::string& name, const std::string& unit, double factor,
                         const std::function<const Three&(const Wedge&)>& value) {
    for (std::size_t k = 0; k < 3; ++k) {
      plain(fmt::format("{}_{}_{}", name, k, unit),
            [value, k, factor](const Wedge& w) { return factor * value(w)[k]; });
    }
  };
  const auto placed = [](int value) { return value > 0 ? std::to_string(value) : std::string(); };
  const double deg = deg_from_rad(1.0);

  text("id", [](const Wedge& w) { return std::to_string(w.id); });
  text("side", [](const Wedge& w) { return w.place.side ? std::string(to_string(*w.place.side)) : ""; });
  text("line", [=](const Wedge& w) { return placed(w.place.line); });
  text("order", [=](const Wedge& w) { return placed(w.place.order); });
  text("turn_deg",
       [](const Wedge& w) { return w.place.side ? number(deg_from_rad(w.place.turn_rad)) : std::string(); });
  point("depth_point", [](const Wedge& w) { return w.depth_point_mm; });
  plain("depth_mm", [](const Wedge& w) { return w.depth_mm; });
  plain("volume_mm3", [](const Wedge& w) { return w.volume_mm3; });
  text("directional_edge", [](const Wedge& w) { return std::to_string(w.directional_edge); });
  text("directional_by", [](const Wedge& w) {
    return std::string(kDirectionalByNames[static_cast<std::size_t>(w.directional_by)]);
  });
  plain("directional_margin", [](const Wedge& w) { return w.directional_margin; });
  three("edge_length", "mm", 1, [](const Wedge& w) -> const Three& { return w.edge_lengths_mm; });
  three("edge_slope", "deg", deg, [](const Wedge& w) -> const Three& { return w.edge_slopes_rad; });
  three("edge_bow", "mm", 1, [](const Wedge& w) -> const Three& { return w.edge_bows_mm; });
  three("face_angle", "deg", deg, [](const Wedge& w) -> const Three& { return w.face_angles_rad; });
  three("opening_angle", "deg", deg, [](const Wedge& w) -> const Three& { return w.opening_angles_rad; });
  three("face_slope", "deg", deg, [](const Wedge& w) -> const Three& { return w.face_slopes_rad; });
  for (std::size_t k = 0; k < 3; ++k) {
    point(fmt::format("exit_point_{}", k), [k](const Wedge& w) { return w.exit_points_mm[k]; });
  }
  for (std::size_t k = 0; k < 3; ++k) {
    point(fmt::format("exit_point_surface_{}", k),
          [k](const Wedge& w) { return w.exit_points_surface_mm[k]; });
    point(fmt::format("exit_point_extent_{}", k), [k](const Wedge& w) { return w.exit_points_extent_mm[k]; });
    normal(fmt::format("face_normal_{}", k), [k](const Wedge& w) { return w.face_normals[k]; });
  }
  normal("surface_normal", [](const Wedge& w) { return w.surface_normal; });
  plain("sigma_depth_point_mm", [](const Wedge& w) { return w.sigma.depth_point_mm; });
  plain("sigma_depth_mm", [](const Wedge& w) { return w.sigma.depth_mm; });
  plain("sigma_volume_mm3", [](const Wedge& w) { return w.sigma.volume_mm3; });
  three("sigma_edge_length", "mm", 1, [](const Wedge& w) -> const Three& { return w.sigma.length_mm; });
  three("sigma_opening_angle", "deg", deg,
        [](const Wedge& w) -> const Three& { return w.sigma.opening_rad; });
  three("sigma_edge", "deg", deg, [](const Wedge& w) -> const Three& { return w.sigma.edge_rad; });
  three("sigma_edge_slope", "deg", deg,
        [](const Wedge& w) -> const Three& { return w.sigma.edge_slope_rad; });
  three("sigma_face_angle", "deg", deg,
        [](const Wedge& w) -> const Three& { return w.sigma.face_angle_rad; });
  three("sigma_face_slope", "deg", deg,
        [](const Wedge& w) -> const Three& { return w.sigma.face_slope_rad; });
  plain("reliability", [](const Wedge& w) { return w.reliability; });
  plain("confidence", [](const Wedge& w) { return w.confidence; });
  plain("intact", [](const Wedge& w) { return w.intact; });
  for (std::size_t k = 0; k < 3; ++k) {
    plain(fmt::format("face_intact_{}", k), [k](const Wedge& w) { return w.faces_intact[k]; });
  }
  for (std::size_t k = 0; k < 3; ++k) {
    text(fmt::format("beyond_mesh_{}", k),
         [k](const Wedge& w) { return std::string(w.beyond_mesh[k] ? "yes" : "no"); });
  }
  plain("roundness", [](const Wedge& w) { return w.roundness; });
  text("vertex_count", [](const Wedge& w) { return std::to_string(w.vertex_count); });
  text("by_hand",
       [](const Wedge& w) { return std::string(kByHandNames[static_cast<std::size_t>(w.by_hand)]); });
  add_label(label, &all);
  return all;
}

}  // namespace

std::string wedge_table(const std::vector<Wedge>& wedges, const FileLabel& label) {
  const std::vector<Column> all = columns(label);
  std::string csv;
  const auto line = [&](const auto& cell) {
    for (std::size_t c = 0; c < all.size(); ++c) {
      if (c > 0) {
        csv.push_back(',');
      }
      csv.append(cell(all[c]));
    }
    csv.append("\r\n");
  };
  line([](const Column& column) { return column.name; });
  for (const Wedge& wedge : wedges) {
    line([&](const Column& column) { return column.value(wedge); });
  }
  return csv;
}

}  // namespace dubsar
