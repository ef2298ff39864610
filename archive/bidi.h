// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Text of both directions of writing, by the Unicode Bidirectional Algorithm (UAX #9).
namespace dubsar {

/// Whether text of an embedding level is written to the left, as Arabic and Hebrew are.
[[nodiscard]] constexpr bool is_leftwards(std::uint8_t level) {
  return level % 2 != 0;
}

/// The embedding level of each byte of a paragraph in UTF-8, which goes the way of its first letter; all
/// bytes of a character have the same.
[[nodiscard]] std::vector<std::uint8_t> bidi_levels(std::string_view paragraph);

/// In which order the pieces of a line are seen from left to right (rule L2), by the levels of its pieces.
[[nodiscard]] std::vector<std::size_t> seen_order(std::span<const std::uint8_t> levels);

/// The text as something by itself: what stands beside it has no say in its order, nor it in theirs.
[[nodiscard]] std::string isolated(std::string_view text);
/// Whether a code point begins or ends something isolated().
[[nodiscard]] bool isolates(std::uint32_t code_point);

}  // namespace dubsar
