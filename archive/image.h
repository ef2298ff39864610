// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dubsar {

using Rgb8 = std::array<std::uint8_t, 3>;

/// A picture of 8-bit sRGB samples, row major, top row first, channels interleaved. A value type.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 3;                 ///< 3 RGB, 4 RGBA
  std::vector<std::uint8_t> bytes;  ///< [height * width * channels]
  double mm_per_px = 0.0;           ///< on the object, 0 when the picture has no scale

  [[nodiscard]] std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
  [[nodiscard]] bool inside(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  [[nodiscard]] Rgb8 rgb(int x, int y) const {
    const std::size_t i = offset(x, y);
    return {bytes[i], bytes[i + 1], bytes[i + 2]};
  }
};

/// An opaque picture of one colour.
[[nodiscard]] Image filled_image(int width, int height, Rgb8 colour, int channels = 3);

/// Sets the pixels of the rectangle that lie inside the image.
void fill_rectangle(Image& image, int x, int y, int width, int height, Rgb8 colour);

/// Copies `from` into `into` with its top left corner at (x, y); what lies outside is cut off. Both have the
/// same number of channels.
void blit(Image& into, const Image& from, int x, int y);

}  // namespace dubsar
