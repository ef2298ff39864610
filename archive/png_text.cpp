// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Chunks of text in a PNG (ISO/IEC 15948, 5.3 and 11.3.4).
#include "archive/png_text.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include "formats/byte_order.h"

namespace dubsar {

namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n";
constexpr std::size_t kFrame = 12;  ///< of a chunk: length, type, checksum
constexpr std::array<std::string_view, 3> kKeys = {"Title", "Description", "Copyright"};

std::string chunk(const std::string& type, const std::string& content) {
  const std::string checked = type + content;
  const auto sum =
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
  std::string out;
  append(out, static_cast<std::uint32_t>(content.size()), std::endian::big);
  out += checked;
  append(out, static_cast<std::uint32_t>(sum), std::endian::big);
  return out;
}

std::string text_chunk(std::string_view key, std::string words) {
  words.resize(std::min(words.size(), words.find('\0')));
  if (words.empty()) {
    return {};
  }
  const std::string name(key);
  const bool plain = std::ranges::all_of(words, [](char c) { return c == '\n' || (c >= 32 && c < 127); });
  // Of the longer kind: not compressed, in no language, the keyword not translated.
  return plain ? chunk("tEXt", name + '\0' + words) : chunk("iTXt", name + std::string(5, '\0') + words);
}

bool is_one_of_ours(std::string_view type, std::string_view content) {
  return (type == "tEXt" || type == "zTXt" || type == "iTXt") &&
         std::ranges::find(kKeys, content.substr(0, content.find('\0'))) != kKeys.end();
}

}  // namespace

Result<std::string> png_with_words(std::string_view png, const PictureWords& words) {
  const std::unexpected<Error> cut = bad_input("PNG", "it is no PNG, or cut short", "make the picture again");
  if (!png.starts_with(kSignature)) {
    return cut;
  }
  std::string out(kSignature);
  bool said = false;
  for (std::string_view rest = png.substr(kSignature.size()); !rest.empty();) {
    if (rest.size() < kFrame) {
      return cut;
    }
    const std::size_t length = load<std::uint32_t>(rest.data(), std::endian::big);
    if (length > rest.size() - kFrame) {
      return cut;
    }
    const std::string_view type = rest.substr(4, 4);
    if (type == "IDAT" && !said) {
      out += text_chunk(kKeys[0], words.title) + text_chunk(kKeys[1], words.description) +
             text_chunk(kKeys[2], words.copyright);
      said = true;
    }
    if (!is_one_of_ours(type, rest.substr(8, length))) {
      out += rest.substr(0, kFrame + length);
    }
    rest.remove_prefix(kFrame + length);
  }
  return said ? Result<std::string>(std::move(out)) : cut;
}

}  // namespace dubsar
