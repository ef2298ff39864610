// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "archive/image.h"
#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// Writes a picture as PNG, atomically. Errors: kUsage for an empty picture, kStorage.
[[nodiscard]] Status write_picture(const std::filesystem::path& file, const Image& image,
                                   const PictureWords& words);

}  // namespace dubsar
