// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/seen_line.h"

#include <fribidi.h>

#include <algorithm>
#include <vector>

#include "archive/bidi.h"
#include "core/utf8.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostBytesOfCharacter = 4;  ///< in UTF-8

/// A letter that a ligature has taken up.
bool is_taken_up(FriBidiChar c) {
  return c == FRIBIDI_CHAR_FILL;
}

}  // namespace

std::string seen_line(std::string_view line) {
  const std::vector<std::uint8_t> levels = bidi_levels(line);
  if (std::ranges::none_of(levels, is_leftwards)) {
    return std::string(line);
  }
  std::vector<FriBidiChar> letters;
  std::vector<FriBidiLevel> of_letters;
  for (std::size_t at = 0; at < line.size();) {
    const CodePoint c = first_code_point(line.substr(at));
    letters.push_back(c.bytes == 0 ? 0xFFFDU : c.value);
    of_letters.push_back(static_cast<FriBidiLevel>(levels[at]));
    at += std::max<std::size_t>(c.bytes, 1);
  }
  const auto count = static_cast<FriBidiStrIndex>(letters.size());
  std::vector<FriBidiCharType> types(letters.size());
  std::vector<FriBidiArabicProp> joins(letters.size());
  fribidi_get_bidi_types(letters.data(), count, types.data());
  fribidi_get_joining_types(letters.data(), count, joins.data());
  fribidi_join_arabic(types.data(), count, of_letters.data(), joins.data());
  constexpr FriBidiFlags kFlags = FRIBIDI_FLAGS_DEFAULT | FRIBIDI_FLAGS_ARABIC;
  fribidi_shape(kFlags, of_letters.data(), count, joins.data(), letters.data());
  const FriBidiParType direction = is_leftwards(levels.front()) ? FRIBIDI_PAR_RTL : FRIBIDI_PAR_LTR;
  if (fribidi_reorder_line(kFlags, types.data(), count, 0, direction, of_letters.data(), letters.data(),
                           nullptr) == 0) {
    return std::string(line);  // no memory
  }
  std::erase_if(letters, is_taken_up);
  std::string out(kMostBytesOfCharacter * letters.size() + 1, '\0');
  const FriBidiStrIndex bytes = fribidi_unicode_to_charset(
      FRIBIDI_CHAR_SET_UTF8, letters.data(), static_cast<FriBidiStrIndex>(letters.size()), out.data());
  out.resize(static_cast<std::size_t>(bytes));
  return out;
}

}  // namespace dubsar
