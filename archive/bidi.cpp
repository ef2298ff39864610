// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/bidi.h"

#include <fribidi.h>

#include <algorithm>
#include <numeric>

#include "core/utf8.h"

namespace dubsar {

namespace {

constexpr std::string_view kFirstStrongIsolate = "\xE2\x81\xA8";     // U+2068
constexpr std::string_view kPopDirectionalIsolate = "\xE2\x81\xA9";  // U+2069

}  // namespace

std::vector<std::uint8_t> bidi_levels(std::string_view paragraph) {
  std::vector<FriBidiChar> characters;
  std::vector<std::size_t> bytes;  // of each character
  for (std::string_view rest = paragraph; !rest.empty(); rest.remove_prefix(bytes.back())) {
    const CodePoint c = first_code_point(rest);
    characters.push_back(c.bytes == 0 ? 0xFFFDU : c.value);
    bytes.push_back(std::max<std::size_t>(c.bytes, 1));
  }
  const auto count = static_cast<FriBidiStrIndex>(characters.size());
  std::vector<FriBidiCharType> types(characters.size());
  std::vector<FriBidiBracketType> brackets(characters.size());
  std::vector<FriBidiLevel> found(characters.size(), 0);
  fribidi_get_bidi_types(characters.data(), count, types.data());
  fribidi_get_bracket_types(characters.data(), count, types.data(), brackets.data());
  FriBidiParType direction = FRIBIDI_PAR_ON;
  if (fribidi_get_par_embedding_levels_ex(types.data(), brackets.data(), count, &direction, found.data()) ==
      0) {
    std::ranges::fill(found, FriBidiLevel{0});  // no memory, or nothing to look at
  }
  std::vector<std::uint8_t> levels;
  levels.reserve(paragraph.size());
  for (std::size_t k = 0; k < characters.size(); ++k) {
    levels.insert(levels.end(), bytes[k], static_cast<std::uint8_t>(found[k]));
  }
  return levels;
}

std::vector<std::size_t> seen_order(std::span<const std::uint8_t> levels) {
  std::vector<std::size_t> order(levels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const unsigned highest = levels.empty() ? 0 : *std::ranges::max_element(levels);
  for (unsigned level = highest; level > 0; --level) {
    const auto inside = [&](std::size_t piece) { return levels[piece] >= level; };
    for (auto from = order.begin(); from != order.end();) {
      from = std::find_if(from, order.end(), inside);
      const auto to = std::find_if_not(from, order.end(), inside);
      std::reverse(from, to);
      from = to;
    }
  }
  return order;
}

std::string isolated(std::string_view text) {
  return std::string(kFirstStrongIsolate) + std::string(text) + std::string(kPopDirectionalIsolate);
}

bool isolates(std::uint32_t code_point) {
  return code_point == 0x2068 || code_point == 0x2069;
}

}  // namespace dubsar
