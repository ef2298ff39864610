// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

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

/// A piece of a line that is not broken.
struct PdfWord {
  std::string text;
  bool bold = false;
  bool soft = false;
  double width = 0;  ///< points
};
struct PdfLine {
  std::vector<PdfWord> words;
  double width = 0;  ///< points
};
using PdfLines = std::vector<PdfLine>;

/// Text broken at blanks into lines of a width, points; a word wider than the line is broken within, at a
/// character.
[[nodiscard]] PdfLines pdf_lines(PdfSheet& sheet, const RichText& text, double size, double width);

/// The first line's baseline lies a line's height below `top`.
void draw_lines(PdfSheet& sheet, const PdfLines& lines, double left, double top, double size, double grey);

[[nodiscard]] double height_of(const PdfLines& lines, double size);

}  // namespace dubsar
