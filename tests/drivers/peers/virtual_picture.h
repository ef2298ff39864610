// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar::test {

/// Bytes of a line in a format of V4L2 (GREY, RGB3, MJPG before it is packed; else two a pixel).
[[nodiscard]] std::uint32_t picture_line_bytes(std::uint32_t fourcc, std::uint32_t width);

/// Grey 7x + 3y, modulo 256, in a format; the brightness of the first four pixels is the frame's number.
/// Paints anew what has another size, else the number alone. `corner` is the grey of the first pixel.
void paint_picture(std::vector<std::uint8_t>& picture, std::uint32_t fourcc, std::uint32_t width,
                   std::uint32_t height, std::uint32_t sequence, std::uint32_t corner = 0);

/// A grey picture as a JPEG of the kind that webcams send: luma and two empty colours of half the width, no
/// Huffman tables.
[[nodiscard]] std::vector<std::uint8_t> packed_picture(const std::vector<std::uint8_t>& grey,
                                                       std::uint32_t width, std::uint32_t height);

}  // namespace dubsar::test
