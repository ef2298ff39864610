// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "archive/image.h"
#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// Encodes an RGB picture as JPEG (JFIF, 4:4:4, so that thin lines keep their colour). A picture with
/// mm_per_px > 0 carries it as dots per inch of the *object*, to the nearest whole one; words go
/// into it as XMP (ISO 16684-1: dc:title, dc:description, dc:rights). The same picture gives the same bytes.
/// Errors: an empty or inconsistent picture (kUsage), libjpeg's own complaint (kInternal).
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_jpeg(const Image& image,
                                                            const PictureWords& words = {}, int quality = 85);

}  // namespace dubsar
