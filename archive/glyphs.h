// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string_view>

#include "archive/image.h"

namespace dubsar {

inline constexpr int kGlyphAdvance = 6;  ///< pixels from one character to the next at scale 1
inline constexpr int kGlyphHeight = 9;   ///< seven above the baseline, two below

/// Draws ASCII text in a built-in 5 × 7 bitmap face (so that pictures need no font file), its top left corner
/// at (x, y), each dot scale × scale pixels. A character that the face lacks becomes a box.
void draw_text(Image& image, int x, int y, std::string_view text, Rgb8 colour, int scale = 1);

/// Width of the text in pixels.
[[nodiscard]] int text_width(std::string_view text, int scale = 1);

}  // namespace dubsar
