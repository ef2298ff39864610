// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Names, notes and file names that people give: any bytes, until looked at.
namespace dubsar {

inline constexpr std::string_view kReplacementCharacter = "\xEF\xBF\xBD";  ///< U+FFFD

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 0;  ///< 0 when this is no UTF-8
};
/// The first of a text that is not empty, by RFC 3629: no overlong forms, no surrogates, nothing above
/// U+10FFFF.
[[nodiscard]] CodePoint first_code_point(std::string_view text);

/// C0, DEL and C1.
[[nodiscard]] constexpr bool is_control(std::uint32_t code_point) {
  return code_point < 0x20 || (code_point >= 0x7F && code_point < 0xA0);
}

[[nodiscard]] bool is_utf8(std::string_view text);
/// The text with U+FFFD for every byte that is no UTF-8.
[[nodiscard]] std::string as_utf8(std::string_view text);

/// Whether it has no control character: a name or a reason that has one would break a list of them, or do
/// things to the terminal that shows it.
[[nodiscard]] bool is_one_line(std::string_view text);
/// as_utf8() with a blank for every control character.
[[nodiscard]] std::string one_line(std::string_view text);

/// The text without the blanks around it: what is nothing else says nothing.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace dubsar
