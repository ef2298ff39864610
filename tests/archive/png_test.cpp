// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <string>

namespace dubsar {
namespace {

/// A picture as libpng's reader sees it. `data` is kept in step by the callback.
struct Decoded {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> bytes;
  png_uint_32 x_per_metre = 0, y_per_metre = 0;
  int unit = -1;
  std::string key, title;
};

struct Source {
  const std::vector<std::uint8_t>* bytes;
  std::size_t at;
};

void read_some(png_structp png, png_bytep into, png_size_t size) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  ASSERT_LE(source->at + size, source->bytes->size());
  std::memcpy(into, source->bytes->data() + source->at, size);
  source->at += size;
}

Decoded decoded(const std::vector<std::uint8_t>& bytes) {
  Decoded out;
  Source source{&bytes, 0};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &source, read_some);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  out.width = static_cast<int>(png_get_image_width(png, info));
  out.height = static_cast<int>(png_get_image_height(png, info));
  out.channels = png_get_channels(png, info);
  png_bytepp rows = png_get_rows(png, info);
  for (int y = 0; y < out.height; ++y) {
    out.bytes.insert(out.bytes.end(), rows[y], rows[y] + out.width * out.channels);
  }
  png_get_pHYs(png, info, &out.x_per_metre, &out.y_per_metre, &out.unit);
  png_textp text = nullptr;
  int texts = 0;
  if (png_get_text(png, info, &text, &texts) > 0) {
    out.key = text[0].key;
    out.title = text[0].text;
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return out;
}

Image gradient(int width, int height, int channels) {
  Image image = filled_image(width, height, {0, 0, 0}, channels);
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    image.bytes[i] = static_cast<std::uint8_t>((i * 37 + i / 11) & 0xFFU);
  }
  return image;
}

TEST(EncodePng, DecodesToTheSamePixelsWithItsScaleAndTitle) {
  Image image = gradient(31, 17, 3);
  image.mm_per_px = 0.05;
  const auto bytes = encode_png(image, "BM 15285, obverse");
  ASSERT_TRUE(bytes) << bytes.error().line();
  const Decoded back = decoded(*bytes);
  EXPECT_EQ(back.width, 31);
  EXPECT_EQ(back.height, 17);
  EXPECT_EQ(back.channels, 3);
  EXPECT_EQ(back.bytes, image.bytes);
  EXPECT_EQ(back.x_per_metre, 20000U);
  EXPECT_EQ(back.y_per_metre, 20000U);
  EXPECT_EQ(back.unit, PNG_RESOLUTION_METER);
  EXPECT_EQ(back.key, "Title");
  EXPECT_EQ(back.title, "BM 15285, obverse");
}

TEST(EncodePng, KeepsTransparencyAndForeignTitles) {
  const Image image = gradient(5, 3, 4);
  const auto bytes = encode_png(image, "Ḫattuša");
  ASSERT_TRUE(bytes);
  const Decoded back = decoded(*bytes);
  EXPECT_EQ(back.channels, 4);
  EXPECT_EQ(back.bytes, image.bytes);
  EXPECT_EQ(back.title, "Ḫattuša");
  EXPECT_EQ(back.unit, -1) << "a picture without a scale must not claim one";
}

TEST(EncodePng, RefusesAPictureThatIsNone) {
  EXPECT_FALSE(encode_png(Image{}));
  Image torn = gradient(4, 4, 3);
  torn.bytes.pop_back();
  const auto refused = encode_png(torn);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
}

TEST(PngDataUri, IsOneUriOfThePng) {
  const auto uri = png_data_uri(gradient(2, 2, 3));
  ASSERT_TRUE(uri);
  EXPECT_EQ(uri->rfind("data:image/png;base64,iVBORw0KGgo", 0), 0U) << uri->substr(0, 60);
}

}  // namespace
}  // namespace dubsar
