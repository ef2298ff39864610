// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "archive/page_blocks.h"
#include "archive/pdf_sheet.h"

namespace dubsar {

inline constexpr double kPdfLeading = 1.35;  ///< from line to line, of the letters' size
inline constexpr double kPdfSoftGrey = 0.4;  ///< of asides

[[nodiscard]] constexpr PdfFont font_of(bool bold) {
  return bold ? PdfFont::kBold : PdfFont::kPlain;
}

/// A piece of a line that is not broken, of one direction of writing and one look.
struct PdfWord {
  std::string text;
  bool bold = false;
  bool soft = false;
  std::uint8_t level = 0;        ///< archive/bidi.h
  bool joins = false;            ///< the piece before it, without a blank
  std::uint8_t blank_level = 0;  ///< of the blank before it
  double width = 0;              ///< points, without that blank
};
/// Words in the order in which they are read.
struct PdfLine {
  std::vector<PdfWord> words;
  double width = 0;  ///< points
};
using PdfLines = std::vector<PdfLine>;

inline constexpr double kPdfOneLine = std::numeric_limits<double>::infinity();  ///< a width: no breaks

/// Text broken at blanks into lines of a width, points; a word wider than the line is broken within, at a
/// character.
[[nodiscard]] PdfLines pdf_lines(const PdfSheet& sheet, const RichText& text, double size, double width);

/// Each line begins at the left, its words in the order in which they are seen.
/// The first line's baseline lies a line's height below `top`.
void draw_lines(PdfSheet& sheet, const PdfLines& lines, double left, double top, double size, double grey);

[[nodiscard]] double height_of(const PdfLines& lines, double size);

/// The cells of a row of a table in parts of at most so many lines, one at least, for a row that is higher
/// than a page.
[[nodiscard]] std::vector<std::vector<PdfLines>> in_parts(const std::vector<PdfLines>& cells,
                                                          std::size_t most_lines);

}  // namespace dubsar
