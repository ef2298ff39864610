// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "archive/base64.h"

namespace dubsar {

namespace {

/// What libpng's callbacks write to. Lives outside the function that calls setjmp, so that a jump skips no
/// destructor.
struct Sink {
  std::vector<std::uint8_t> bytes;
  std::array<char, 128> message{};
};

void append(png_structp png, png_bytep data, png_size_t size) {
  auto* sink = static_cast<Sink*>(png_get_io_ptr(png));
  sink->bytes.insert(sink->bytes.end(), data, data + size);
}

void flush(png_structp) {}

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  auto* sink = static_cast<Sink*>(png_get_error_ptr(png));
  std::snprintf(sink->message.data(), sink->message.size(), "%s", text);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Plain values and pointers only between setjmp and a jump. Returns false when libpng gave up.
bool write_png(Sink& sink, const Image& image, const std::uint8_t* const* rows,
               std::vector<png_text>& texts) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, on_error, on_warning);
  if (png == nullptr) {
    return false;
  }
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &sink, append, flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               image.channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (image.mm_per_px > 0) {
    const auto per_metre =
        static_cast<png_uint_32>(std::lround(std::clamp(1000.0 / image.mm_per_px, 1.0, 1e9)));
    png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
  }
  if (!texts.empty()) {
    png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
  }
  // Up and Sub suit shaded surfaces; trying every filter costs twice the time for 2 %.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_set_compression_level(png, 6);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    png_write_row(png, rows[y]);
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

/// A keyword and its text, which libpng wants as its own.
struct Text {
  std::string key;
  std::string words;
};

png_text as_png(Text& text) {
  const bool plain =
      std::ranges::all_of(text.words, [](char c) { return c == '\n' || (c >= 32 && c < 127); });
  png_text out{};
  out.compression = plain ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
  out.key = text.key.data();
  out.text = text.words.data();
  return out;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_png(const Image& image, std::string_view title) {
  return encode_png(image, PictureWords{.title = std::string(title)});
}

Result<std::vector<std::uint8_t>> encode_png(const Image& image, const PictureWords& words) {
  if (image.width <= 0 || image.height <= 0 || (image.channels != 3 && image.channels != 4) ||
      image.bytes.size() != image.offset(0, image.height)) {
    return fail(ErrorKind::kUsage, "the picture is empty or its size and bytes disagree", "PNG");
  }
  std::vector<const std::uint8_t*> rows;
  rows.reserve(static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    rows.push_back(image.bytes.data() + image.offset(0, y));
  }
  std::array<Text, 3> said = {
      {{"Title", words.title}, {"Description", words.description}, {"Copyright", words.copyright}}};
  std::vector<png_text> texts;
  for (Text& text : said) {
    text.words = text.words.substr(0, text.words.find('\0'));
    if (!text.words.empty()) {
      texts.push_back(as_png(text));
    }
  }
  Sink sink;
  if (!write_png(sink, image, rows.data(), texts)) {
    return fail(ErrorKind::kInternal, std::string("libpng: ") + sink.message.data(), "PNG");
  }
  return std::move(sink.bytes);
}

Result<std::string> png_data_uri(const Image& image, std::string_view title) {
  const auto bytes = encode_png(image, title);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return "data:image/png;base64," + base64(*bytes);
}

}  // namespace dubsar
