// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/scale_bar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>

#include "archive/glyphs.h"

namespace dubsar {

namespace {

constexpr int kFifths = 5;

std::string words(double length_mm) {
  std::ostringstream text;
  text << length_mm << " mm";
  return text.str();
}

int bar_px(double length_mm, double mm_per_px) {
  return static_cast<int>(std::lround(length_mm / mm_per_px));
}

}  // namespace

ScaleBar scale_bar_for(double mm_per_px, int picture_width_px, int least_text_scale, int most_text_scale) {
  ScaleBar bar;
  const double width_mm = mm_per_px * picture_width_px;
  if (!(width_mm > 0) || !std::isfinite(width_mm)) {
    return bar;
  }
  const auto fits = [&](double mm) { return mm <= 0.5 * width_mm && mm >= 0.06 * width_mm; };
  if (!fits(bar.length_mm)) {
    const double decade_mm = std::pow(10.0, std::floor(std::log10(0.5 * width_mm)));
    for (const double step : {1.0, 2.0, 5.0}) {  // the longest that fits
      bar.length_mm = step == 1.0 || fits(decade_mm * step) ? decade_mm * step : bar.length_mm;
    }
  }
  bar.text_scale =
      std::clamp(picture_width_px / 280, least_text_scale, std::max(least_text_scale, most_text_scale));
  const int text_px = text_width(words(bar.length_mm), bar.text_scale);
  bar.width_px = bar_px(bar.length_mm, mm_per_px) + 3 * kGlyphAdvance / 2 * bar.text_scale + text_px;
  bar.height_px = kGlyphHeight * bar.text_scale;
  return bar;
}

void draw_scale_bar(Image& image, const ScaleBar& bar, int x, int y, Rgb8 ink) {
  if (!(image.mm_per_px > 0) || bar.width_px <= 0) {
    return;
  }
  const int length = bar_px(bar.length_mm, image.mm_per_px);
  const int thick = 3 * bar.text_scale;
  const int line = std::max(1, bar.text_scale / 2);
  const int top = y + 2 * bar.text_scale;
  const auto edge = [&](int fifth) { return x + length * fifth / kFifths; };
  for (int fifth = 0; fifth < kFifths; ++fifth) {
    if (fifth % 2 == 0) {
      fill_rectangle(image, edge(fifth), top, edge(fifth + 1) - edge(fifth), thick, ink);
    }
  }
  fill_rectangle(image, x, top, length, line, ink);
  fill_rectangle(image, x, top + thick - line, length, line, ink);
  fill_rectangle(image, x + length - line, top, line, thick, ink);
  draw_text(image, x + length + 3 * kGlyphAdvance / 2 * bar.text_scale, y, words(bar.length_mm), ink,
            bar.text_scale);
}

Rgb8 ink_on(Rgb8 ground) {
  const bool is_light = 2 * ground[0] + 5 * ground[1] + ground[2] > 4 * 255;
  return is_light ? Rgb8{24, 24, 24} : Rgb8{235, 235, 235};
}

int text_scale_beside(double mm_per_px) {
  constexpr double kWordsMm = 1.5;
  constexpr double kLargest = 100;
  return mm_per_px > 0
             ? static_cast<int>(std::lround(std::clamp(kWordsMm / (mm_per_px * kGlyphHeight), 1.0, kLargest)))
             : 1;
}

int scale_bar_rows(double mm_per_px) {
  return mm_per_px > 0 ? 2 * kGlyphHeight * text_scale_beside(mm_per_px) : 0;
}

Image with_scale_bar(const Image& picture, Rgb8 ground) {
  const int rows = scale_bar_rows(picture.mm_per_px);
  if (rows == 0) {
    return picture;
  }
  ScaleBar bar;
  int scale = text_scale_beside(picture.mm_per_px);
  for (; scale > 0; --scale) {
    bar = scale_bar_for(picture.mm_per_px, picture.width, scale, scale);
    if (bar.width_px <= picture.width) {
      break;
    }
  }
  Image ruled = filled_image(picture.width, picture.height + rows, ground, picture.channels);
  ruled.mm_per_px = picture.mm_per_px;
  blit(ruled, picture, 0, 0);
  if (scale > 0) {
    draw_scale_bar(ruled, bar, std::min(rows / 4, picture.width - bar.width_px),
                   picture.height + (rows - bar.height_px) / 2, ink_on(ground));
  }
  return ruled;
}

}  // namespace dubsar
