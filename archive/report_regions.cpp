// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Every place that is red or excused: number, face, place, size, reason, and a picture of the largest.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/report_sections.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostRows = 500;

const char* state_of(const RedRegion& region) {
  if (region.state == RegionState::kRed) {
    return "red";
  }
  return region.excuse == Excuse::kUnreachable ? "unreachable"
         : region.excuse == Excuse::kUnneeded  ? "unneeded"
                                               : "excused";
}

std::string place_of(const ReportInput& input, const RedRegion& region) {
  const Eigen::Vector3d p = input.tablet_from_model * region.center_mm;
  return fixed(p.x(), 1) + ", " + fixed(p.y(), 1) + ", " + fixed(p.z(), 1);
}

std::string cards(const ReportInput& input, const ReportPictures& pictures) {
  if (pictures.regions.empty()) {
    return {};
  }
  std::string html = "<div class=\"places\">\n";
  for (const RegionPicture& one : pictures.regions) {
    const RedRegion& region = input.red_map.regions[one.region];
    html += fmt::format(
        "<figure{}><img alt=\"Place {}\" width=\"{}\" height=\"{}\" src=\"{}\"><figcaption><b>{}</b> {}, {}, "
        "{} mm²<br>at {} mm{}{}</figcaption></figure>\n",
        region.state == RegionState::kRed ? " class=\"open\"" : "", region_number(one.region),
        one.image.width, one.image.height, one.uri, region_number(one.region), state_of(region),
        to_string(region.face), fixed(region.area_mm2, 2), place_of(input, region),
        region.reason.empty() ? "" : "<br>", html_escaped(region.reason));
  }
  return html + "</div>\n";
}

/// What has no picture, one line each, and in one line what is left even of these.
std::string rest_table(const ReportInput& input, const std::vector<std::size_t>& rest) {
  if (rest.empty()) {
    return {};
  }
  std::string rows;
  double left_mm2 = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const RedRegion& region = input.red_map.regions[rest[k]];
    if (k >= kMostRows) {
      left_mm2 += std::isfinite(region.area_mm2) ? region.area_mm2 : 0.0;
      continue;
    }
    rows += table_row({std::to_string(region_number(rest[k])), state_of(region), to_string(region.face),
                       place_of(input, region), fixed(region.area_mm2, 2), html_escaped(region.reason)},
                      region.state == RegionState::kRed ? "open" : "");
  }
  std::string html =
      html_table("regions", {"No", "State", "Face", "Place x, y, z, mm", "Area, mm²", "Reason"}, rows);
  if (rest.size() > kMostRows) {
    html += "<p>" + std::to_string(rest.size() - kMostRows) + " smaller places, " + fixed(left_mm2, 2) +
            " mm² together, are left out of this table; the red map file lists them all.</p>\n";
  }
  return html;
}

std::string strays_line(const RedMap& map) {
  const auto strays = std::ranges::count_if(map.regions, [](const RedRegion& r) { return is_stray(r); });
  return strays == 0 ? std::string()
                     : "<p>Besides, " + counted(strays, "group", "groups") +
                           " of stray returns, where no clay is missing (in the air around the tablet, or "
                           "inside the clay): the red map file lists them.</p>\n";
}

}  // namespace

std::string regions_section(const ReportInput& input, const ReportPictures& pictures) {
  std::string html = "<section>\n<h2>Red and excused places</h2>\n";
  std::vector<std::size_t> order = regions_by_weight(input.red_map);
  if (order.empty()) {
    return html + "<p>None.</p>\n" + strays_line(input.red_map) + "</section>\n";
  }
  const RegionSum red = sum_of(input.red_map, RegionState::kRed);
  const RegionSum excused = sum_of(input.red_map, RegionState::kExcused);
  html += "<p>" + counted(red.count, "red place", "red places") + ", " + fixed(red.area_mm2, 2) + " mm²; " +
          counted(excused.count, "excused place", "excused places") + ", " + fixed(excused.area_mm2, 2) +
          " mm².</p>\n";
  std::erase_if(order, [&](std::size_t k) {
    return std::ranges::find(pictures.regions, k, &RegionPicture::region) != pictures.regions.end();
  });
  return html + cards(input, pictures) + rest_table(input, order) + strays_line(input.red_map) +
         "<p class=\"aside\">An area is that of the hole which the red border encloses, by estimate: what "
         "nobody has seen has no samples. Places are in the tablet’s frame: x to the right and y to the top "
         "edge of the obverse, z out of it, from the middle of the tablet. Numbers are those of the red map "
         "picture, and positions in the red map file counted from 1.</p>\n</section>\n";
}

}  // namespace dubsar
