// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// The same PNG with these words in the place of its own Title, Description and Copyright, as encode_png()
/// writes them; everything else is as it was, to the byte. Errors: kBadInput for what is no PNG.
[[nodiscard]] Result<std::string> png_with_words(std::string_view png, const PictureWords& words);

}  // namespace dubsar
