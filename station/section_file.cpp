// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/section_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "archive/html.h"
#include "formats/atomic_file.h"

namespace dubsar {

namespace {

constexpr double kMarginMm = 6;
constexpr double kTextMm = 2.4;

}  // namespace

std::string section_csv(const CrossSection& section) {
  std::string out = "piece,along_mm,height_mm,x_mm,y_mm,z_mm\n";
  for (std::size_t k = 0; k < section.lines.size(); ++k) {
    for (const CrossSection::Point& p : section.lines[k]) {
      out += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", k, p.along_mm, p.height_mm,
                         p.place_mm.x(), p.place_mm.y(), p.place_mm.z());
    }
  }
  return out;
}

std::string section_svg(const CrossSection& section, const PictureWords& words) {
  const double top = std::max(0.0, section.highest_mm) + kMarginMm;
  const double width = section.last_along_mm - section.first_along_mm + 2 * kMarginMm;
  const double height = top - std::min(0.0, section.lowest_mm) + 2 * kMarginMm;
  const auto x = [&](double along) { return kMarginMm + along - section.first_along_mm; };
  const auto y = [&](double above) { return top - above; };
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" "
      "width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" viewBox=\"0 0 {0:.3f} "
      "{1:.3f}\">\n<title>{2}</title>\n<metadata>{3}</metadata>\n",
      width, height, html_escaped(words.title), rdf_of(words));
  out += fmt::format(
      "<line x1=\"{:.3f}\" y1=\"{:.3f}\" x2=\"{:.3f}\" y2=\"{:.3f}\" stroke=\"#888888\" stroke-width=\"0.1\" "
      "stroke-dasharray=\"0.8 0.5\"/>\n",
      x(0), y(0), x(section.length_mm), y(0));
  for (const auto& line : section.lines) {
    out += "<polyline fill=\"none\" stroke=\"#000000\" stroke-width=\"0.15\" points=\"";
    for (const CrossSection::Point& p : line) {
      out += fmt::format("{:.4f},{:.4f} ", x(p.along_mm), y(p.height_mm));
    }
    out += "\"/>\n";
  }
  const auto write = [&](double at_x, double at_y, const char* anchor, const std::string& text) {
    out += fmt::format(
        "<text x=\"{:.3f}\" y=\"{:.3f}\" font-size=\"{}\" font-family=\"sans-serif\" "
        "text-anchor=\"{}\">{}</text>\n",
        at_x, at_y, kTextMm, anchor, text);
  };
  if (section.lowest_mm < 0) {
    out += fmt::format(
        "<line x1=\"{0:.3f}\" y1=\"{1:.3f}\" x2=\"{0:.3f}\" y2=\"{2:.3f}\" stroke=\"#c02020\" "
        "stroke-width=\"0.1\"/>\n",
        x(section.lowest_along_mm), y(0), y(section.lowest_mm));
    write(x(section.lowest_along_mm), y(section.lowest_mm) + 1.2 * kTextMm, "middle",
          fmt::format("{:.3f} mm", -section.lowest_mm));
  }
  write(x(0.5 * section.length_mm), y(std::max(0.0, section.highest_mm)) - 0.6 * kTextMm, "middle",
        fmt::format("{:.3f} mm", section.length_mm));
  return out + "</svg>\n";
}

Status write_section(const CrossSection& section, const std::filesystem::path& file, const FileLabel& label) {
  const std::string ending = file.extension().string();
  if (ending != ".csv" && ending != ".svg") {
    return fail(ErrorKind::kUsage, "a cross-section is not written as '" + ending + "'", file.string(),
                "write .csv or .svg");
  }
  return write_file_atomically(file, ending == ".csv"
                                         ? section_csv(section)
                                         : section_svg(section, picture_words(label, file.stem().string())));
}

}  // namespace dubsar
