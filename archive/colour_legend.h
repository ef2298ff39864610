// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "archive/image.h"

namespace dubsar {

/// What the colours of a picture mean.
struct ColourLegend {
  std::string name;           ///< of what they show, with its unit; ASCII
  std::vector<Rgb8> colours;  ///< evenly from the lowest value to the highest; none: of no numbers
  double low = 0;
  double high = 0;
  std::vector<std::pair<std::string, Rgb8>> marks;  ///< colours that stand for a word each
};

inline constexpr int kLegendRows = 22;  ///< pixels from its top to its foot at text scale 1 (glyphs.h)

/// Draws its name with the colours below it, top left corner at (x, y), in words as large as
/// `most_text_scale`, or as fits between margins of x.
void draw_colour_legend(Image& image, const ColourLegend& legend, int x, int y, int most_text_scale,
                        Rgb8 ink);

}  // namespace dubsar
