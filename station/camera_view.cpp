// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/camera_view.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace dubsar {

namespace {

/// As one byte per pixel: of a finer format the upper eight bits of its range.
GrayImage eight_bits(const Frame& frame) {
  GrayImage out(static_cast<int>(frame.width), static_cast<int>(frame.height));
  const std::uint32_t scale = full_scale(frame.format);
  for (std::uint32_t v = 0; v < frame.height; ++v) {
    const std::uint8_t* row = frame.pixels.data() + std::size_t{v} * frame.stride_bytes;
    std::uint8_t* to = out.pixels.data() + std::size_t{v} * frame.width;
    if (frame.format == PixelFormat::kMono8) {
      std::copy_n(row, frame.width, to);
      continue;
    }
    for (std::uint32_t u = 0; u < frame.width; ++u) {
      std::uint16_t value = 0;
      std::memcpy(&value, row + 2 * std::size_t{u}, sizeof value);
      to[u] = static_cast<std::uint8_t>(255U * std::min<std::uint32_t>(value, scale) / scale);
    }
  }
  return out;
}

}  // namespace

CameraView camera_view_of(const Frame& frame, int most_px) {
  const auto whole = std::make_shared<const GrayImage>(eight_bits(frame));
  const GrayImage& image = *whole;
  std::vector<PixelMark> marks;
  CameraView out;
  out.image = whole;
  out.exposure = judge_exposure(image.view(), &marks);
  const int stride = std::max(1, (std::max(image.width, image.height) + most_px - 1) / most_px);
  out.width = (image.width + stride - 1) / stride;
  out.height = (image.height + stride - 1) / stride;
  const auto cells = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
  out.grey.assign(cells, 0);
  out.mark.assign(cells, PixelMark::kPlain);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const auto from = image.index(u, v);
      const std::size_t to = static_cast<std::size_t>(v / stride) * static_cast<std::size_t>(out.width) +
                             static_cast<std::size_t>(u / stride);
      // The brightest stands for its block: a stripe one pixel thin must not go.
      out.grey[to] = std::max(out.grey[to], image.pixels[from]);
      if (out.mark[to] == PixelMark::kPlain || marks[from] == PixelMark::kSaturated) {
        out.mark[to] = marks[from];
      }
    }
  }
  return out;
}

}  // namespace dubsar
