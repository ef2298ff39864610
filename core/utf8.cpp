// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/utf8.h"

#include <array>

namespace dubsar {

namespace {

/// Calls `one(code point, its bytes)` for each; a byte that is no UTF-8 comes as U+FFFD.
template <class Visit>
void for_each_code_point(std::string_view text, const Visit& one) {
  while (!text.empty()) {
    const CodePoint c = first_code_point(text);
    if (c.bytes == 0) {
      one(0xFFFDU, kReplacementCharacter);
      text.remove_prefix(1);
    } else {
      one(c.value, text.substr(0, c.bytes));
      text.remove_prefix(c.bytes);
    }
  }
}

}  // namespace

CodePoint first_code_point(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = byte(0);
  if (lead < 0x80) {
    return {lead, 1};
  }
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) {
    return {};
  }
  std::uint32_t value = lead & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return {};
    }
    value = (value << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kLeast[length] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) {
    return {};
  }
  return {value, length};
}

bool is_utf8(std::string_view text) {
  return as_utf8(text) == text;
}

std::string as_utf8(std::string_view text) {
  std::string out;
  for_each_code_point(text, [&](std::uint32_t, std::string_view bytes) { out += bytes; });
  return out;
}

bool is_one_line(std::string_view text) {
  bool plain = true;
  for_each_code_point(text, [&](std::uint32_t c, std::string_view) { plain = plain && !is_control(c); });
  return plain;
}

std::string one_line(std::string_view text) {
  std::string out;
  for_each_code_point(text, [&](std::uint32_t c, std::string_view bytes) {
    out += is_control(c) ? std::string_view(" ") : bytes;
  });
  return out;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

}  // namespace dubsar
