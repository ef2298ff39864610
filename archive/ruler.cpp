// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/ruler.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "archive/glyphs.h"

namespace dubsar {

namespace {

constexpr double kMmPerCm = 10;
constexpr double kBlockMm = 1.6;   ///< height of the blocks
constexpr double kTickMm = 1.4;    ///< of a millimetre
constexpr double kFifthMm = 2.2;   ///< of five
constexpr double kDigitsMm = 2.6;  ///< height of the numbers
constexpr double kGapMm = 0.6;

int px(double mm, double mm_per_px) {
  return static_cast<int>(std::lround(mm / mm_per_px));
}
int text_scale(double mm_per_px) {
  return std::max(1, px(kDigitsMm, mm_per_px) / kGlyphHeight);
}
std::string words(int cm, int last) {
  return cm == last ? std::to_string(cm) + " cm" : std::to_string(cm);
}

}  // namespace

Ruler ruler_for(double mm_per_px, int width_px) {
  Ruler ruler;
  if (!(mm_per_px > 0)) {
    return ruler;
  }
  const int scale = text_scale(mm_per_px);
  for (const int cm : {5, 2, 1}) {
    // The last number stands under the end of the ruler with its digit, and its unit beyond.
    const int beyond = text_width(words(cm, cm), scale) - text_width("0", scale) / 2;
    const int width = px(kMmPerCm * cm, mm_per_px) + beyond;
    if (width <= width_px) {
      ruler.length_cm = cm;
      ruler.width_px = width;
      ruler.height_px = px(kFifthMm + kBlockMm + kGapMm, mm_per_px) + kGlyphHeight * scale;
      break;
    }
  }
  return ruler;
}

void draw_ruler(Image& image, const Ruler& ruler, int x, int y, Rgb8 ink) {
  if (ruler.length_cm == 0 || !(image.mm_per_px > 0)) {
    return;
  }
  const double scale = image.mm_per_px;
  const int line = std::max(1, px(0.12, scale));
  const int length = px(kMmPerCm * ruler.length_cm, scale);
  const int block_top = y + px(kFifthMm, scale);
  const int block = std::max(2, px(kBlockMm, scale));
  for (int mm = 0; mm <= 10 * ruler.length_cm; ++mm) {
    const int at = std::min(x + px(mm, scale), x + length - line);
    const int high = px(mm % 5 == 0 ? kFifthMm : kTickMm, scale);
    fill_rectangle(image, at, block_top - high, line, high, ink);
  }
  for (int cm = 0; cm < ruler.length_cm; cm += 2) {
    const int from = px(kMmPerCm * cm, scale);
    fill_rectangle(image, x + from, block_top, px(kMmPerCm * (cm + 1), scale) - from, block, ink);
  }
  fill_rectangle(image, x, block_top, length, line, ink);
  fill_rectangle(image, x, block_top + block - line, length, line, ink);
  fill_rectangle(image, x, block_top, line, block, ink);
  fill_rectangle(image, x + length - line, block_top, line, block, ink);
  const int digits = text_scale(scale);
  for (int cm = 0; cm <= ruler.length_cm; ++cm) {
    const int half = cm == 0 ? 0 : text_width(std::to_string(cm), digits) / 2;
    draw_text(image, x + px(kMmPerCm * cm, scale) - half, block_top + block + px(kGapMm, scale),
              words(cm, ruler.length_cm), ink, digits);
  }
}

}  // namespace dubsar
