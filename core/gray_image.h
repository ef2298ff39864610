// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dubsar {

/// Somebody else's 8-bit grey pixels, row major. Pixel (0, 0) is the upper left one; its centre has the
/// coordinates (0, 0).
struct GrayView {
  const std::uint8_t* pixels = nullptr;
  int width = 0;
  int height = 0;
  std::size_t stride_bytes = 0;  ///< from one row to the next, at least width

  [[nodiscard]] const std::uint8_t* row(int v) const {
    return pixels + static_cast<std::size_t>(v) * stride_bytes;
  }
  [[nodiscard]] bool empty() const { return pixels == nullptr || width <= 0 || height <= 0; }
  [[nodiscard]] bool same_size(const GrayView& other) const {
    return width == other.width && height == other.height;
  }
};

/// An 8-bit grey image that owns its pixels, without padding between rows.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< [width*height]

  GrayImage() = default;
  GrayImage(int columns, int rows, std::uint8_t value = 0)
      : width(columns),
        height(rows),
        pixels(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), value) {}

  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  }
  [[nodiscard]] std::uint8_t at(int u, int v) const { return pixels[index(u, v)]; }
  [[nodiscard]] GrayView view() const {
    return {pixels.data(), width, height, static_cast<std::size_t>(width)};
  }
};

}  // namespace dubsar
