// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/picture_file.h"

#include <span>

#include "archive/png.h"
#include "formats/atomic_file.h"

namespace dubsar {

Status write_picture(const std::filesystem::path& file, const Image& image, const PictureWords& words) {
  const auto png = encode_png(image, words);
  if (!png) {
    return std::unexpected(png.error());
  }
  return write_file_atomically(file, std::as_bytes(std::span(*png)));
}

}  // namespace dubsar
