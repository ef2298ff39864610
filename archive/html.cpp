// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/html.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "core/number_text.h"
#include "core/utf8.h"

namespace dubsar {

namespace {

bool is_unwelcome(std::uint32_t c) {
  const bool turns_direction = (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
  return (is_control(c) && c != '\n' && c != '\t') || turns_direction || (c & 0xFFFE) == 0xFFFE ||
         (c >= 0xFDD0 && c <= 0xFDEF);
}

}  // namespace

std::string cleaned(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const CodePoint c = first_code_point(text);
    if (c.value == '\r') {  // a line ends as on Windows, or on an old Macintosh
      out += text.starts_with("\r\n") ? "" : "\n";
    } else if (c.bytes == 0 || is_unwelcome(c.value)) {
      out += kReplacementCharacter;
    } else {
      out += text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes == 0 ? 1 : c.bytes);
  }
  return out;
}

std::string html_escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (const char c : cleaned(text)) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "\xE2\x80\x93";
  }
  return fixed_text(value, decimals);
}

std::string counted(long long count, std::string_view one, std::string_view many) {
  return std::to_string(count) + " " + std::string(count == 1 ? one : many);
}

}  // namespace dubsar
