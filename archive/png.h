// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "archive/image.h"
#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// Encodes a picture as PNG (ISO/IEC 15948), sRGB. A picture with mm_per_px > 0 carries it as pHYs (pixels
/// per metre of the *object*, so that a viewer prints it at 1:1); a title goes into the Title text (tEXt when
/// it is plain ASCII, else iTXt in UTF-8). The same picture gives the same bytes. Errors: an empty or
/// inconsistent picture (kUsage), libpng's own complaint (kInternal).
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_png(const Image& image, std::string_view title = {});
/// Description and copyright likewise, under the names that PNG registers for them.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_png(const Image& image, const PictureWords& words);

/// "data:image/png;base64,…" of a picture.
[[nodiscard]] Result<std::string> png_data_uri(const Image& image, std::string_view title = {});

}  // namespace dubsar
