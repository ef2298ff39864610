// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report.h"

#include <algorithm>
#include <cmath>

#include "archive/html.h"
#include "archive/png.h"
#include "archive/report_sections.h"
#include "archive/report_style.h"
#include "archive/six_views.h"

namespace dubsar {

namespace {

constexpr double kScreenWidthMm = 235;  // of the text column at 96 pixels per inch
constexpr double kPaperWidthMm = 175;   // of A4 between its margins
constexpr double kGapsMm = 12;

/// Millimetres to a hundredth, rounded down so that the sum of the columns does not outgrow the page.
double floored(double value) {
  return std::floor(value * 100.0) / 100.0;
}

Result<std::string> picture(const Image& image, const std::string& title, const std::string& alt) {
  const Result<std::string> uri = png_data_uri(image, title);
  if (!uri) {
    return std::unexpected(uri.error());
  }
  return "<img alt=\"" + html_escaped(alt) + "\" width=\"" + std::to_string(image.width) + "\" height=\"" +
         std::to_string(image.height) + "\" style=\"--mm: " + fixed(image.width * image.mm_per_px, 2) +
         "mm\" src=\"" + *uri + "\">";
}

Result<std::string> six_sides(const ReportInput& input, const SixViews& views) {
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
    const Result<std::string> img = picture(views[face], input.title + ", " + name, "The " + name);
    if (!img) {
      return img;
    }
    html.append("<figure style=\"grid-area: ").append(name).append("\">").append(*img);
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

Result<std::string> red_sheet(const ReportInput& input, const RenderScene& scene, const SixViewOptions& clay,
                              const JobContext& job) {
  SixViewOptions options = clay;
  options.render.style = RenderStyle::kRedMap;
  options.render.longest_px = std::max(200, input.longest_px * 6 / 10);
  const Result<Image> sheet = render_six_view_sheet(scene, options, job);
  if (!sheet) {
    return std::unexpected(sheet.error());
  }
  const Result<std::string> img =
      picture(*sheet, input.title + ", red map", "Red map of the six sides, laid out as above");
  if (!img) {
    return img;
  }
  return "<section>\n<h2>Red map</h2>\n<figure class=\"sheet\">" + *img +
         "<figcaption><span class=\"swatch\" style=\"background: #d61e26\"></span>sampled too thinly, still "
         "to scan"
         "<span class=\"swatch\" style=\"background: #e2a02a\"></span>interpolated, or excused"
         "<span class=\"swatch\" style=\"background: #3a3638\"></span>the inside, seen through a hole"
         "</figcaption></figure>\n</section>\n";
}

Result<std::string> pictures(const ReportInput& input, const JobContext& job) {
  const RenderScene scene(input.model, &input.red_points);
  const RenderScene bare(input.model);
  if (bare.empty()) {
    return "<section>\n<h2>The six sides</h2>\n<p>No surface was meshed, so there is nothing to "
           "show.</p>\n</section>\n";
  }
  SixViewOptions options;
  options.tablet_from_model = input.tablet_from_model;
  options.render.longest_px = input.longest_px;
  const Result<SixViews> views = render_six_views(bare, options, job);
  if (!views) {
    return std::unexpected(views.error());
  }
  Result<std::string> html = six_sides(input, *views);
  if (!html) {
    return html;
  }
  const Result<std::string> red = red_sheet(input, scene, options, job);
  if (!red) {
    return red;
  }
  return *html + *red;
}

std::string header(const ReportInput& input) {
  const auto fact = [](const std::string& name, const std::string& value) {
    return value.empty() ? std::string() : "<dt>" + name + "</dt><dd>" + html_escaped(value) + "</dd>\n";
  };
  const Mesh& mesh = input.model;
  const std::string size =
      mesh.faces.empty()
          ? std::string("no surface")
          : counted(static_cast<long long>(mesh.positions.size()), "vertex", "vertices") + ", " +
                counted(static_cast<long long>(mesh.faces.size()), "triangle", "triangles");
  return "<header>\n<p class=\"kicker\">Scan report</p>\n<h1>" +
         html_escaped(input.title.empty() ? "Untitled tablet" : input.title) + "</h1>\n<dl>\n" +
         fact("Made", input.when) + fact("Device", input.device) + fact("Mesh", size) +
         fact("Program", input.tool_version) + "</dl>\n</header>\n";
}

}  // namespace

Result<std::string> report_html(const ReportInput& input, const JobContext& job) {
  const Result<std::string> drawn = pictures(input, job);
  if (!drawn) {
    return drawn;
  }
  const std::string title = input.title.empty() ? "Untitled tablet" : input.title;
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      html_escaped(title) + ": scan report</title>\n<style>" + kReportStyle +
      "</style>\n</head>\n<body>\n<main>\n";
  html += header(input);
  html += verdict_section(input);
  html += next_section(input);
  html += *drawn;
  html += checklist_section(input);
  html += regions_section(input);
  html += scans_section(input);
  html += accuracy_section(input);
  html += not_measured_section(input);
  html += timings_section(input);
  html +=
      "<footer>This page holds all that it shows: it needs no network, no script and no other "
      "file.</footer>\n";
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace dubsar
