// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/gray_image.h"
#include "core/result.h"

namespace dubsar {

/// Larger pictures are refused before memory is asked for.
inline constexpr int kMostImagePixels = 100'000'000;

/// A picture as a camera or a program writes it: PNG, JPEG or PGM (P5, 8 bit), told by its first bytes.
/// Colour becomes luma (ITU-R BT.601), of the numbers as they stand: what a PNG says of their light bends
/// none. Errors: kBadInput, for a PNG of 16 bits too.
[[nodiscard]] Result<GrayImage> parse_gray(std::string_view bytes, const std::string& where);
[[nodiscard]] Result<GrayImage> read_gray(const std::filesystem::path& path);

/// As an 8-bit grey PNG; the same picture gives the same bytes. Errors: kUsage for an empty picture,
/// kStorage.
[[nodiscard]] Status write_gray_png(const GrayImage& image, const std::filesystem::path& path);

}  // namespace dubsar
