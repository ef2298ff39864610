// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/behind_page.h"

#include <algorithm>
#include <array>

#include "archive/glyphs.h"
#include "archive/html.h"
#include "archive/report_sections.h"
#include "archive/report_style.h"

namespace dubsar {

namespace {

constexpr std::string_view kHead =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"dubsar-page\" content=\"behind\">\n";

}  // namespace

std::string behind_html(const BehindPage& page) {
  const std::string title = html_escaped(page.title.empty() ? "Untitled tablet" : page.title);
  const std::string kicker = html_escaped(page.kicker);
  return std::string(kHead) + "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         "<title>" + title + ": behind</title>\n<style>" + kReportStyle +
         "</style>\n</head>\n<body>\n<main>\n<header>\n<p class=\"kicker\">" + kicker + "</p>\n<h1>" + title +
         "</h1>\n</header>\n<section class=\"verdict no\">\n<h2>Behind</h2>\n<p>The session was changed on " +
         html_escaped(page.when) + ": " + html_escaped(page.what) +
         ". What stood here was worked out before that, and is not shown any more.</p>\n<p>To have this page "
         "anew, " +
         html_escaped(page.mend) + ".</p>\n</section>\n" + page_foot();
}

Image behind_picture(const BehindPage& page) {
  constexpr int kScale = 2;
  constexpr int kMarginPx = 16;
  constexpr int kLinePx = 2 * kScale * kGlyphHeight;
  constexpr Rgb8 kWhite{255, 255, 255};
  constexpr Rgb8 kRedInk{179, 22, 31};
  const std::array<std::string, 3> lines = {"behind: the session was changed on " + page.when, page.what,
                                            "to have this picture anew, " + page.mend};
  int width = 0;
  for (const std::string& line : lines) {
    width = std::max(width, text_width(line, kScale));
  }
  Image image =
      filled_image(width + 2 * kMarginPx, static_cast<int>(lines.size()) * kLinePx + 2 * kMarginPx, kWhite);
  int y = kMarginPx;
  for (const std::string& line : lines) {
    draw_text(image, kMarginPx, y, line, kRedInk, kScale);
    y += kLinePx;
  }
  return image;
}

bool is_behind_page(std::string_view page) {
  return page.starts_with(kHead);
}

}  // namespace dubsar
