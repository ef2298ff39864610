// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pdf_lines.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace dubsar {

namespace {

/// Bytes of a word, whole characters of it and one at least, that are no wider than a line. Never more than
/// about two lines are measured at once: some scripts have no blanks, and a note may be one long word.
std::size_t fitting(PdfSheet& sheet, std::string_view word, PdfFont font, double size, double width) {
  constexpr std::size_t kFirstLook = 64;
  const auto character_from = [&](std::size_t at) {
    while (at < word.size() && (static_cast<unsigned char>(word[at]) & 0xc0U) == 0x80U) {
      ++at;
    }
    return std::min(at, word.size());
  };
  const auto fits = [&](std::size_t end) {
    return sheet.text_width(word.substr(0, end), font, size) <= width;
  };
  std::size_t low = character_from(1);
  std::size_t high = character_from(kFirstLook);
  for (; fits(high); high = character_from(2 * high)) {
    low = high;
    if (low == word.size()) {
      return low;
    }
  }
  while (character_from(low + 1) < high) {
    const std::size_t middle = character_from((low + high) / 2);
    const std::size_t next = middle < high && middle > low ? middle : character_from(low + 1);
    (fits(next) ? low : high) = next;
  }
  return low;
}

}  // namespace

PdfLines pdf_lines(PdfSheet& sheet, const RichText& text, double size, double width) {
  PdfLines lines(1);
  const double blank = sheet.text_width(" ", PdfFont::kPlain, size);
  const auto add = [&](PdfWord word) {
    word.width = sheet.text_width(word.text, font_of(word.bold), size);
    const double gap = lines.back().words.empty() ? 0 : blank;
    if (!lines.back().words.empty() && lines.back().width + gap + word.width > width) {
      lines.emplace_back();
    } else {
      lines.back().width += gap;
    }
    lines.back().width += word.width;
    lines.back().words.push_back(std::move(word));
  };
  for (const TextRun& run : text) {
    if (run.breaks && !lines.back().words.empty()) {
      lines.emplace_back();
    }
    std::size_t at = 0;
    while (at < run.text.size()) {
      const std::size_t end = std::min(run.text.find(' ', at), run.text.size());
      std::string_view word = std::string_view(run.text).substr(at, end - at);
      at = end + 1;
      while (!word.empty()) {
        const std::size_t fits = fitting(sheet, word, font_of(run.bold), size, width);
        add({std::string(word.substr(0, fits)), run.bold, run.soft});
        word.remove_prefix(fits);
      }
    }
  }
  return lines;
}

void draw_lines(PdfSheet& sheet, const PdfLines& lines, double left, double top, double size, double grey) {
  const double blank = sheet.text_width(" ", PdfFont::kPlain, size);
  double y = top;
  for (const PdfLine& line : lines) {
    y -= kPdfLeading * size;
    double x = left;
    for (const PdfWord& word : line.words) {
      sheet.text(word.text, x, y, font_of(word.bold), size, word.soft ? kPdfSoftGrey : grey);
      x += word.width + blank;
    }
  }
}

double height_of(const PdfLines& lines, double size) {
  return kPdfLeading * size * static_cast<double>(lines.size());
}

}  // namespace dubsar
