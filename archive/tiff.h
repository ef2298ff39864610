// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "archive/image.h"
#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// Encodes an RGB picture as baseline TIFF 6.0 with LZW and horizontal prediction. A picture with
/// mm_per_px > 0 carries it as dots per inch of the *object*; title and description go into ImageDescription,
/// the copyright into Copyright (UTF-8, as is usual), `software` into Software. The same picture gives the
/// same bytes. Errors: an empty or inconsistent picture (kUsage), libtiff's own complaint (kInternal).
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_tiff(const Image& image, const PictureWords& words,
                                                            const std::string& software);

}  // namespace dubsar
