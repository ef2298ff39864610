// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dubsar::v4l2 {

/// The luma of one picture of motion JPEG, straight from its own component: no colour is made that nobody
/// asks for. False when the bytes are no whole picture of this size, with the reason in `why`; the pixels are
/// then of no meaning. Bytes that some cameras leave before or between the parts of a picture do no harm, nor
/// do Huffman tables that they leave out.
[[nodiscard]] bool decode_luma(std::span<const std::uint8_t> picture, std::uint32_t width,
                               std::uint32_t height, std::span<std::uint8_t> pixels, std::string& why);

}  // namespace dubsar::v4l2
