// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dubsar {

/// One form of a font. Lengths are shares of the letters' size.
struct ShapedGlyph {
  std::uint32_t index = 0;  ///< in the font
  double x = 0;             ///< of its origin, from the left end of the text
  double y = 0;             ///< likewise, upwards from the baseline
  std::string text;         ///< what it stands for: a letter, or the letters that are joined in it
};

struct ShapedText {
  std::vector<ShapedGlyph> glyphs;  ///< from left to right
  double width = 0;
};

/// Turns text into the forms that a font has for it: letters joined, marks in their places, as the script
/// wants it. For one thread.
class Shaper {
 public:
  /// Nothing when the file is no font.
  [[nodiscard]] static std::optional<Shaper> open(const char* file);
  Shaper(Shaper&&) noexcept;
  Shaper& operator=(Shaper&&) = delete;
  ~Shaper();

  /// UTF-8, all of one direction (archive/bidi.h).
  [[nodiscard]] ShapedText shape(std::string_view text, bool leftwards) const;
  [[nodiscard]] bool has(std::uint32_t code_point) const;

 private:
  struct Impl;
  explicit Shaper(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether it belongs to the letter before it: an accent, a vowel point.
[[nodiscard]] bool is_mark(std::uint32_t code_point);

}  // namespace dubsar
