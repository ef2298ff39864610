// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

#include "archive/image.h"
#include "core/result.h"

namespace dubsar {

/// Writes a picture as PNG, atomically. Errors: kUsage for an empty picture, kStorage.
[[nodiscard]] Status write_picture(const std::filesystem::path& file, const Image& image,
                                   const std::string& title);

}  // namespace dubsar
