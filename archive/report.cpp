// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/png.h"
#include "archive/print_scale.h"
#include "archive/report_sections.h"
#include "archive/report_style.h"

namespace dubsar {

namespace {

constexpr double kScreenWidthMm = 235;  // of the text column at 96 pixels per inch
constexpr double kPaperWidthMm = 175;   // of A4 between its margins
constexpr double kGapsMm = 6;  ///< between the columns of the six sides: twice what the style sheet says

/// Millimetres to a hundredth, rounded down so that the sum of the columns does not outgrow the page.
double floored(double value) {
  return std::floor(value * 100.0) / 100.0;
}

/// more_style: further declarations, each ending in a semicolon.
std::string picture_tag(const Image& image, const std::string& uri, const std::string& alt,
                        const std::string& more_style = {}) {
  return "<img alt=\"" + html_escaped(alt) + "\" width=\"" + std::to_string(image.width) + "\" height=\"" +
         std::to_string(image.height) + "\" style=\"" + more_style +
         "--mm: " + fixed(image.width * image.mm_per_px, 2) + "mm\" src=\"" + uri + "\">";
}

std::string percent(double part, double of) {
  return fixed(of > 0 ? 100 * part / of : 0, 3) + "%";
}

/// The bar beside the reverse: as long as there is room for below the right edge.
double bar_mm(double room_mm) {
  double best = 0.5;
  for (const double mm : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    best = mm <= 0.7 * room_mm ? mm : best;
  }
  return best;
}

Result<std::string> six_sides(const ReportPictures& pictures) {
  if (pictures.empty) {
    return "<section>\n<h2>The six sides</h2>\n<p>No surface was meshed, so there is nothing to "
           "show.</p>\n</section>\n";
  }
  const SixViews& views = pictures.sides;
  const Image& obverse = views[Face::kObverse];
  const double mm_per_px = obverse.mm_per_px;
  const auto wide_mm = [&](Face face) { return views[face].width * mm_per_px; };
  const double left_mm = wide_mm(Face::kLeft);
  const double right_mm = wide_mm(Face::kRight);
  const double column_mm = std::max(
      {wide_mm(Face::kObverse), wide_mm(Face::kReverse), wide_mm(Face::kTop), wide_mm(Face::kBottom)});
  const double cross_mm = left_mm + column_mm + right_mm;
  const double screen_scale = floored(std::min(4.0, (kScreenWidthMm - kGapsMm) / cross_mm));
  const double print_scale = std::min(1.0, floored((kPaperWidthMm - kGapsMm) / cross_mm));
  std::string html =
      "<section>\n<h2>The six sides</h2>\n<div class=\"cross\" style=\"--scale: " +
      fixed(std::max(0.01, screen_scale), 2) + "; --print-scale: " + fixed(std::max(0.01, print_scale), 2) +
      "; --wide: " + fixed(cross_mm, 2) + "mm; --left: " + fixed(left_mm, 2) +
      "fr; --column: " + fixed(column_mm, 2) + "fr; --right: " + fixed(right_mm, 2) + "fr\">\n";
  for (const Face face : kSixViewOrder) {
    const std::string name = to_string(face);
    const Result<std::string> uri = png_data_uri(views[face], name);
    if (!uri) {
      return uri;
    }
    html.append("<figure style=\"grid-area: ").append(name).append("\">");
    const double room_mm = face == Face::kLeft ? left_mm : face == Face::kRight ? right_mm : column_mm;
    html +=
        picture_tag(views[face], *uri, "The " + name, "--share: " + percent(wide_mm(face), room_mm) + "; ");
    html.append("<figcaption>").append(name).append("</figcaption></figure>\n");
  }
  html += "<div class=\"bar\" style=\"grid-area: bar; --share: " + percent(bar_mm(right_mm), right_mm) +
          "\">" + fmt::format("{} mm", bar_mm(right_mm)) +
          "</div>\n</div>\n<p class=\"aside\">Drawn from the "
          "mesh, all to one scale, " +
          fixed(1000.0 * mm_per_px, 1) + " µm to a pixel, lit from the upper left. " +
          printed_words(print_scale) + "</p>\n</section>\n";
  return html;
}

constexpr std::string_view kTabletList = "<dl class=\"tablet\">\n";

std::string tablet_list(const TabletWords& tablet) {
  std::string entries;
  for (const auto& [name, value] : tablet) {
    entries += dl_entry(html_escaped(name), html_escaped(value));
  }
  return entries.empty() ? entries : std::string(kTabletList) + entries + "</dl>\n";
}

std::string shown_title(const std::string& title) {
  return html_escaped(title.empty() ? "Untitled tablet" : title);
}

/// Puts `text` in the place of what lies between two marks; false where they are not there.
bool put_between(std::string& page, std::string_view before, std::string_view after,
                 const std::string& text) {
  const std::size_t from = page.find(before);
  const std::size_t to = from == std::string::npos ? from : page.find(after, from + before.size());
  if (to == std::string::npos) {
    return false;
  }
  page.replace(from + before.size(), to - from - before.size(), text);
  return true;
}

std::string header(const ReportInput& input, const std::string& kicker) {
  const auto fact = [](const std::string& name, const std::string& value) {
    return dl_entry(name, html_escaped(value));
  };
  const Mesh& mesh = input.model;
  const std::string size =
      mesh.faces.empty()
          ? std::string("no surface")
          : counted(static_cast<long long>(mesh.positions.size()), "vertex", "vertices") + ", " +
                counted(static_cast<long long>(mesh.faces.size()), "triangle", "triangles");
  return "<header>\n<p class=\"kicker\">" + kicker + "</p>\n<h1>" + shown_title(input.title) + "</h1>\n" +
         tablet_list(input.tablet) + "<dl>\n" + fact("Scanned", scanned_in_words(input.entries)) +
         fact("Made", input.when) + fact("Device", input.device) + fact("Mesh", size) +
         fact("Program", input.tool_version) + "</dl>\n</header>\n";
}

}  // namespace

std::string red_sheet_section(const ReportPictures& pictures) {
  if (pictures.empty) {
    return {};
  }
  const std::string img = picture_tag(pictures.red_page, pictures.red_page_uri,
                                      "Red map of the six sides, unrolled round the obverse");
  return "<section>\n<h2>Red map</h2>\n<figure class=\"sheet\">" + img +
         "<figcaption><span class=\"swatch\" style=\"background: #d61e26\"></span>sampled too thinly, still "
         "to scan"
         "<span class=\"swatch\" style=\"background: #e2a02a\"></span>interpolated, or excused"
         "<span class=\"swatch\" style=\"background: #3a3638\"></span>the inside, seen through a hole"
         "<span class=\"swatch ring\"></span>a place of the list, with its number"
         "</figcaption></figure>\n</section>\n";
}

std::string page_head(const ReportInput& input, const std::string& kind, const std::string& kicker) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         shown_title(input.title) + ": " + kind + "</title>\n<style>" + kReportStyle +
         "</style>\n</head>\n<body>\n<main>\n" + header(input, kicker);
}

std::string page_foot() {
  return "<footer>This page holds all that it shows: it needs no network, no script and no other "
         "file.</footer>\n</main>\n</body>\n</html>\n";
}

std::string page_renamed(std::string page, const std::string& title, const TabletWords& tablet) {
  const std::size_t head_ends = page.find("</header>");
  if (head_ends == std::string::npos) {
    return page;
  }
  std::string head = page.substr(0, head_ends);
  for (const char* kind : {": scan report</title>", ": checklist</title>", ": behind</title>"}) {
    put_between(head, "<title>", kind, shown_title(title));
  }
  if (const std::size_t old = head.find(kTabletList); old != std::string::npos) {
    constexpr std::string_view kEnd = "</dl>\n";
    head.erase(old, head.find(kEnd, old) + kEnd.size() - old);
  }
  if (!put_between(head, "<h1>", "</h1>", shown_title(title))) {
    return page;
  }
  head.insert(head.find("</h1>\n") + 6, tablet_list(tablet));
  return head + page.substr(head_ends);
}

Result<std::string> report_html(const ReportInput& input, const ReportPictures& pictures) {
  std::string html = page_head(input, "scan report", "Scan report");
  html += verdict_section(input);
  html += next_section(input);
  const Result<std::string> sides = six_sides(pictures);
  if (!sides) {
    return sides;
  }
  html += *sides;
  html += red_sheet_section(pictures);
  html += checklist_section(input);
  html += sign_off_section(input);
  html += regions_section(input, pictures);
  html += scans_section(input);
  html += wedges_section(input.wedges, input.wedge_profiles);
  html += accuracy_section(input);
  html += not_measured_section(input);
  html += timings_section(input);
  return html + page_foot();
}

}  // namespace dubsar
