// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/image.h"

namespace dubsar {

/// A ruled bar with its length in words.
struct ScaleBar {
  double length_mm = 10;
  int width_px = 0;   ///< of the bar and its words
  int height_px = 0;  ///< likewise
  int text_scale = 2;
};

/// 10 mm where that suits the picture's width; where it would be too long or too short to read, the longest
/// of 1, 2, 5, 20, 50 … mm that is at most half as wide as the picture. Words as large as suits the width,
/// but within these bounds.
[[nodiscard]] ScaleBar scale_bar_for(double mm_per_px, int picture_width_px, int least_text_scale = 1,
                                     int most_text_scale = 6);

/// Of ink on a ground: black where that is light, white where it is dark.
[[nodiscard]] Rgb8 ink_on(Rgb8 ground);

/// Draws the bar with its top left corner at (x, y): alternating fifths, and "10 mm" beside them. The bar is
/// as long on the picture as its length at image.mm_per_px, to the nearest pixel.
void draw_scale_bar(Image& image, const ScaleBar& bar, int x, int y, Rgb8 ink);

/// Size of the words beside a picture, about 1.5 mm of the object high at any scale.
[[nodiscard]] int text_scale_beside(double mm_per_px);
/// Rows that with_scale_bar() adds: the same for all pictures of a scale, 72 at 600 dots per inch. 0 without
/// a scale.
[[nodiscard]] int scale_bar_rows(double mm_per_px);
/// The picture with a scale bar below it, on rows of their own: what was at a pixel is there still. Where not
/// even the smallest words have room the rows are empty. Without a scale: the picture.
[[nodiscard]] Image with_scale_bar(const Image& picture, Rgb8 ground);

}  // namespace dubsar
