// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/image.h"

namespace dubsar {

/// A ruler in whole centimetres, as museums lay one beside a tablet.
struct Ruler {
  int length_cm = 0;  ///< 5, 2 or 1; 0 where even 1 cm has no room
  int width_px = 0;
  int height_px = 0;
};

/// The longest of 5, 2 and 1 cm that has room in width_px, its last number included.
[[nodiscard]] Ruler ruler_for(double mm_per_px, int width_px);

/// Draws it with its top left corner at (x, y): millimetres along the upper edge, centimetres in alternate
/// blocks, numbers below. To scale at image.mm_per_px, to the nearest pixel.
void draw_ruler(Image& image, const Ruler& ruler, int x, int y, Rgb8 ink);

}  // namespace dubsar
