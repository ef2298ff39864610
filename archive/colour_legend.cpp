// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/colour_legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "archive/glyphs.h"

namespace dubsar {

namespace {

/// Length of the bar of colours, in letters.
constexpr int kBarLetters = 16;
/// A box is as high as a capital.
constexpr int kCapital = 7;

/// Its width in pixels; drawn where there is an image.
int lay(const ColourLegend& legend, int x, int y, int scale, Rgb8 ink, Image* image) {
  const int gap = kGlyphAdvance * scale;
  int at = x;
  const auto say = [&](const std::string& words) {
    if (image != nullptr) {
      draw_text(*image, at, y, words, ink, scale);
    }
    at += text_width(words, scale) + gap;
  };
  const auto box = [&](int width, Rgb8 colour) {
    if (image != nullptr) {
      fill_rectangle(*image, at, y, width, kCapital * scale, colour);
    }
    at += width;
  };
  say(legend.name);
  const int name_px = at - gap - x;
  at = x;
  y += kLegendRows / 2 * scale;
  if (!legend.colours.empty()) {
    say(fmt::format("{:.3g}", legend.low));
    const std::size_t length = static_cast<std::size_t>(kBarLetters) * static_cast<std::size_t>(gap);
    for (std::size_t k = 0; k < length; ++k) {
      box(1, legend.colours[k * legend.colours.size() / length]);
    }
    at += gap;
    say(fmt::format("{:.3g}", legend.high));
  }
  for (const auto& [word, colour] : legend.marks) {
    box(kCapital * scale, colour);
    at += gap / 2;
    say(word);
  }
  return std::max(name_px, at - gap - x);
}

}  // namespace

void draw_colour_legend(Image& image, const ColourLegend& legend, int x, int y, int most_text_scale,
                        Rgb8 ink) {
  int scale = std::max(1, most_text_scale);
  while (scale > 1 && lay(legend, x, y, scale, ink, nullptr) > image.width - 2 * x) {
    --scale;
  }
  lay(legend, x, y, scale, ink, &image);
}

}  // namespace dubsar
