// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report.h"

#include <algorithm>
#include <cmath>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/png.h"
#include "archive/report_sections.h"
#include "archive/report_style.h"

namespace dubsar {

namespace {

constexpr double kScreenWidthMm = 235;  // of the text column at 96 pixels per inch
constexpr double kPaperWidthMm = 175;   // of A4 between its margins
constexpr double kGapsMm = 12;

/// Millimetres to a hundredth, rounded down so that the sum of the columns does not outgrow the page.
double floored(double value) {
  return std::floor(value * 100.0) / 100.0;
}

std::string picture_tag(const Image& image, const std::string& uri, const std::string& alt) {
  return "<img alt=\"" + html_escaped(alt) + "\" width=\"" + std::to_string(image.width) + "\" height=\"" +
         std::to_string(image.height) + "\" style=\"--mm: " + fixed(image.width * image.mm_per_px, 2) +
         "mm\" src=\"" + uri + "\">";
}

Result<std::string> six_sides(const ReportInput& input, const ReportPictures& pictures) {
  if (pictures.empty) {
    return "<section>\n<h2>The six sides</h2>\n<p>No surface was meshed, so there is nothing to "
           "show.</p>\n</section>\n";
  }
  const SixViews& views = pictures.sides;
  const Image& obverse = views[Face::kObverse];
  const double mm_per_px = obverse.mm_per_px;
  const int cross_px = views[Face::kLeft].width + views[Face::kRight].width +
                       std::max({obverse.width, views[Face::kReverse].width, views[Face::kTop].width});
  const double cross_mm = cross_px * mm_per_px;
  const double screen_scale = floored(std::min(4.0, (kScreenWidthMm - kGapsMm) / cross_mm));
  const double print_scale = std::min(1.0, floored((kPaperWidthMm - kGapsMm) / cross_mm));
  std::string html = "<section>\n<h2>The six sides</h2>\n<div class=\"cross\" style=\"--scale: " +
                     fixed(std::max(0.01, screen_scale), 2) +
                     "; --print-scale: " + fixed(std::max(0.01, print_scale), 2) + "\">\n";
  for (const Face face : kSixViewOrder) {
    const std::string name = to_string(face);
    const Result<std::string> uri = png_data_uri(views[face], input.title + ", " + name);
    if (!uri) {
      return uri;
    }
    html.append("<figure style=\"grid-area: ").append(name).append("\">");
    html += picture_tag(views[face], *uri, "The " + name);
    html.append("<figcaption>").append(name).append("</figcaption></figure>\n");
  }
  html +=
      "<div class=\"bar\" style=\"grid-area: bar\">10 mm</div>\n</div>\n<p class=\"aside\">Drawn from the "
      "mesh, all to one scale, " +
      fixed(1000.0 * mm_per_px, 1) + " µm to a pixel, lit from the upper left. " +
      (print_scale == 1.0 ? "Printed at 100 % they are life size."
                          : "Printed at 100 % they are " + fixed(100 * print_scale, 0) + " % of life size.") +
      "</p>\n</section>\n";
  return html;
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
  return "<header>\n<p class=\"kicker\">" + kicker + "</p>\n<h1>" +
         html_escaped(input.title.empty() ? "Untitled tablet" : input.title) + "</h1>\n<dl>\n" +
         fact("Made", input.when) + fact("Device", input.device) + fact("Mesh", size) +
         fact("Program", input.tool_version) + "</dl>\n</header>\n";
}

}  // namespace

std::string red_sheet_section(const ReportInput& input, const ReportPictures& pictures) {
  if (pictures.empty) {
    return {};
  }
  const std::string img =
      picture_tag(pictures.red_page, pictures.red_page_uri,
                  "Red map of the six sides of " + input.title + ", unrolled round the obverse");
  return "<section>\n<h2>Red map</h2>\n<figure class=\"sheet\">" + img +
         "<figcaption><span class=\"swatch\" style=\"background: #d61e26\"></span>sampled too thinly, still "
         "to scan"
         "<span class=\"swatch\" style=\"background: #e2a02a\"></span>interpolated, or excused"
         "<span class=\"swatch\" style=\"background: #3a3638\"></span>the inside, seen through a hole"
         "<span class=\"swatch ring\"></span>a place of the list, with its number"
         "</figcaption></figure>\n</section>\n";
}

std::string page_head(const ReportInput& input, const std::string& kind, const std::string& kicker) {
  const std::string title = input.title.empty() ? "Untitled tablet" : input.title;
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         html_escaped(title) + ": " + kind + "</title>\n<style>" + kReportStyle +
         "</style>\n</head>\n<body>\n<main>\n" + header(input, kicker);
}

std::string page_foot() {
  return "<footer>This page holds all that it shows: it needs no network, no script and no other "
         "file.</footer>\n</main>\n</body>\n</html>\n";
}

Result<std::string> report_html(const ReportInput& input, const ReportPictures& pictures) {
  std::string html = page_head(input, "scan report", "Scan report");
  html += verdict_section(input);
  html += next_section(input);
  const Result<std::string> sides = six_sides(input, pictures);
  if (!sides) {
    return sides;
  }
  html += *sides;
  html += red_sheet_section(input, pictures);
  html += checklist_section(input);
  html += sign_off_section(input);
  html += regions_section(input, pictures);
  html += scans_section(input);
  html += wedges_section(input);
  html += accuracy_section(input);
  html += not_measured_section(input);
  html += timings_section(input);
  return html + page_foot();
}

}  // namespace dubsar
