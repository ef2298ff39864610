// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/gray_image.h"
#include "core/result.h"

namespace dubsar {

/// The luma of a JPEG picture. Errors: kBadInput; a picture that ends too soon is one.
[[nodiscard]] Result<GrayImage> parse_gray_jpeg(std::string_view bytes, const std::string& where);

}  // namespace dubsar
