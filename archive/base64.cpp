// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/base64.h"

namespace dubsar {

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = bytes.size() - i;
    const std::uint32_t group = (std::uint32_t{bytes[i]} << 16U) |
                                (have > 1 ? std::uint32_t{bytes[i + 1]} << 8U : 0U) |
                                (have > 2 ? std::uint32_t{bytes[i + 2]} : 0U);
    text += kDigits[(group >> 18U) & 63U];
    text += kDigits[(group >> 12U) & 63U];
    text += have > 1 ? kDigits[(group >> 6U) & 63U] : '=';
    text += have > 2 ? kDigits[group & 63U] : '=';
  }
  return text;
}

std::optional<std::string> from_base64(std::string_view text) {
  const auto value = [](char c) -> unsigned {
    if (c >= 'A' && c <= 'Z') {
      return static_cast<unsigned>(c - 'A');
    }
    if (c >= 'a' && c <= 'z') {
      return static_cast<unsigned>(c - 'a') + 26;
    }
    if (c >= '0' && c <= '9') {
      return static_cast<unsigned>(c - '0') + 52;
    }
    return c == '+' ? 62 : c == '/' ? 63 : 64;
  };
  if (text.size() % 4 != 0) {
    return std::nullopt;
  }
  std::string out;
  out.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const bool last = at + 4 == text.size();
    const std::size_t padding = !last ? 0 : text[at + 3] != '=' ? 0 : text[at + 2] != '=' ? 1 : 2;
    unsigned bits = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const unsigned six = k < 4 - padding ? value(text[at + k]) : 0;
      if (six > 63) {
        return std::nullopt;
      }
      bits = bits << 6U | six;
    }
    for (std::size_t k = 0; k < 3 - padding; ++k) {
      out.push_back(static_cast<char>(bits >> (16 - 8 * k) & 0xffU));
    }
  }
  return out;
}

}  // namespace dubsar
