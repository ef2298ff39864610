// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/image.h"

#include <algorithm>

namespace dubsar {

Image filled_image(int width, int height, Rgb8 colour, int channels) {
  Image image;
  image.width = std::max(width, 0);
  image.height = std::max(height, 0);
  image.channels = channels;
  image.bytes.assign(image.offset(0, image.height), 255);
  fill_rectangle(image, 0, 0, image.width, image.height, colour);
  return image;
}

void fill_rectangle(Image& image, int x, int y, int width, int height, Rgb8 colour) {
  const int x_end = std::min(x + width, image.width);
  const int y_end = std::min(y + height, image.height);
  for (int row = std::max(y, 0); row < y_end; ++row) {
    for (int col = std::max(x, 0); col < x_end; ++col) {
      std::copy(colour.begin(), colour.end(),
                image.bytes.begin() + static_cast<std::ptrdiff_t>(image.offset(col, row)));
    }
  }
}

void blit(Image& into, const Image& from, int x, int y) {
  const int x_begin = std::max(x, 0);
  const int x_end = std::min(x + from.width, into.width);
  if (x_begin >= x_end || into.channels != from.channels) {
    return;
  }
  for (int row = std::max(y, 0); row < std::min(y + from.height, into.height); ++row) {
    const auto begin = from.bytes.begin() + static_cast<std::ptrdiff_t>(from.offset(x_begin - x, row - y));
    const auto end = from.bytes.begin() + static_cast<std::ptrdiff_t>(from.offset(x_end - x, row - y));
    std::copy(begin, end, into.bytes.begin() + static_cast<std::ptrdiff_t>(into.offset(x_begin, row)));
  }
}

}  // namespace dubsar
