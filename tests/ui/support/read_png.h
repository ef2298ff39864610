// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <png.h>

#include <cstring>
#include <filesystem>

#include "archive/image.h"

namespace dubsar::test {

/// RGBA; empty when it cannot be read.
inline Image read_png(const std::filesystem::path& file) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  Image image;
  if (png_image_begin_read_from_file(&png, file.c_str()) == 0) {
    return image;
  }
  png.format = PNG_FORMAT_RGBA;
  image.width = static_cast<int>(png.width);
  image.height = static_cast<int>(png.height);
  image.channels = 4;
  image.bytes.resize(PNG_IMAGE_SIZE(png));
  png_image_finish_read(&png, nullptr, image.bytes.data(), 0, nullptr);
  return image;
}

}  // namespace dubsar::test
