// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/gray_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/byte_order.h"
#include "formats/gray_jpeg.h"

namespace dubsar {

namespace {

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpeg = "\xff\xd8\xff";
constexpr const char* kMend = "give a whole PNG, JPEG or PGM picture";

/// A PNG without what says of which light its numbers are (ISO/IEC 15948, 11.3.3): by that the library would
/// bend them for a screen, 64 of linear light to 136.
std::string without_light(std::string_view png) {
  constexpr std::size_t kFrame = 12;  // of a chunk: length, type, checksum
  constexpr std::array<std::string_view, 4> kOfLight = {"gAMA", "cHRM", "iCCP", "sRGB"};
  std::string out(kPng);
  std::string_view rest = png.substr(kPng.size());
  while (rest.size() >= kFrame) {
    const std::size_t length = load<std::uint32_t>(rest.data(), std::endian::big);
    if (length > rest.size() - kFrame) {
      break;
    }
    if (std::ranges::find(kOfLight, rest.substr(4, 4)) == kOfLight.end()) {
      out += rest.substr(0, kFrame + length);
    }
    rest.remove_prefix(kFrame + length);
  }
  return out += rest;  // of one that is cut short the library says so
}

Result<GrayImage> parse_png(std::string_view whole, const std::string& where) {
  const std::string bytes = without_light(whole);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    return bad_input(where, std::string("the picture cannot be read: ") + png.message, kMend);
  }
  if (png.width == 0 || png.height == 0 ||
      static_cast<std::uint64_t>(png.width) * png.height > static_cast<std::uint64_t>(kMostImagePixels)) {
    png_image_free(&png);
    return bad_input(where, "the picture has no sensible size", kMend);
  }
  if ((png.format & PNG_FORMAT_FLAG_LINEAR) != 0) {
    // libpng takes them for linear light and bends them, and nobody says how many of the bits are used.
    png_image_free(&png);
    return bad_input(where, "the picture has 16 bits a colour", "give it with 8, as the camera's full range");
  }
  // Colour comes as it stands and is weighed here: the library's own luma is that of linear light.
  png.format = PNG_FORMAT_RGB;
  GrayImage image(static_cast<int>(png.width), static_cast<int>(png.height));
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(png));
  const png_color black{0, 0, 0};
  const bool done = png_image_finish_read(&png, &black, rgb.data(), 0, nullptr) != 0;
  const std::string message = png.message;
  png_image_free(&png);
  if (!done) {
    return bad_input(where, "the picture cannot be read: " + message, kMend);
  }
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    // 0.299, 0.587, 0.114 in 1/65536, which keeps grey what is grey.
    image.pixels[i] = static_cast<std::uint8_t>(
        (19595U * rgb[3 * i] + 38470U * rgb[3 * i + 1] + 7471U * rgb[3 * i + 2] + 32768U) >> 16U);
  }
  return image;
}

/// The next number of a PGM header, comments skipped.
std::optional<int> pgm_number(std::string_view bytes, std::size_t& at) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (at < bytes.size() && (blank(bytes[at]) || bytes[at] == '#')) {
    if (bytes[at] == '#') {
      while (at < bytes.size() && bytes[at] != '\n') {
        ++at;
      }
    } else {
      ++at;
    }
  }
  int value = 0;
  int digits = 0;
  while (at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9' && digits < 7) {
    value = 10 * value + (bytes[at] - '0');
    ++at;
    ++digits;
  }
  return digits > 0 ? std::optional(value) : std::nullopt;
}

Result<GrayImage> parse_pgm(std::string_view bytes, const std::string& where) {
  std::size_t at = 2;
  const auto width = pgm_number(bytes, at);
  const auto height = pgm_number(bytes, at);
  const auto most = pgm_number(bytes, at);
  if (!width || !height || !most || *width < 1 || *height < 1 || *most < 1 || *most > 255 ||
      static_cast<std::int64_t>(*width) * *height > kMostImagePixels) {
    return bad_input(where, "the PGM header makes no sense, or has more than 8 bits", kMend);
  }
  ++at;  // one blank ends the header
  const auto count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  // Or two, of lines as Windows has them: then there is one byte more than there are pixels.
  if (at + count < bytes.size() && bytes.substr(at - 1, 2) == "\r\n") {
    ++at;
  }
  if (at > bytes.size() || bytes.size() - at < count) {
    return bad_input(where, "the picture ends too soon", kMend);
  }
  GrayImage image(*width, *height);
  std::memcpy(image.pixels.data(), bytes.data() + at, count);
  if (*most != 255) {
    for (std::uint8_t& pixel : image.pixels) {
      pixel = static_cast<std::uint8_t>(std::min<int>(pixel, *most) * 255 / *most);
    }
  }
  return image;
}

}  // namespace

Result<GrayImage> parse_gray(std::string_view bytes, const std::string& where) {
  if (bytes.starts_with(kPng)) {
    return parse_png(bytes, where);
  }
  if (bytes.starts_with(kJpeg)) {
    return parse_gray_jpeg(bytes, where);
  }
  if (bytes.starts_with("P5")) {
    return parse_pgm(bytes, where);
  }
  return bad_input(where, "this is no picture that is known here", "give a PNG, JPEG or PGM (P5) picture");
}

Result<GrayImage> read_gray(const std::filesystem::path& path) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30U;
  const Result<std::string> bytes = read_whole_file(path, kMostBytes);
  return bytes ? parse_gray(*bytes, path.string()) : std::unexpected(bytes.error());
}

Status write_gray_png(const GrayImage& image, const std::filesystem::path& path) {
  if (image.pixels.empty()) {
    return fail(ErrorKind::kUsage, "there is no picture to write", path.string());
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    return fail(ErrorKind::kInternal, std::string("the picture could not be encoded: ") + png.message,
                path.string());
  }
  bytes.resize(size);
  return write_file_atomically(path, bytes);
}

}  // namespace dubsar
