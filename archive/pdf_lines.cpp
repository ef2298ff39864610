// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/pdf_lines.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "archive/bidi.h"
#include "archive/shaper.h"
#include "core/utf8.h"

namespace dubsar {

namespace {

double width_of(const PdfSheet& sheet, const PdfWord& word, std::string_view text, double size) {
  return sheet.text_width(text, is_leftwards(word.level), font_of(word.bold), size);
}

/// Bytes of a piece's text, whole characters of it with their marks and one at least, that are no wider than
/// a line. Never more than about two lines are measured at once: some scripts have no blanks, and a note may
/// be one long word.
std::size_t fitting(const PdfSheet& sheet, const PdfWord& piece, std::string_view text, double size,
                    double width) {
  constexpr std::size_t kFirstLook = 64;
  const auto character_from = [&](std::size_t at) {
    while (at < text.size() && ((static_cast<unsigned char>(text[at]) & 0xc0U) == 0x80U ||
                                is_mark(first_code_point(text.substr(at)).value))) {
      ++at;
    }
    return std::min(at, text.size());
  };
  const auto fits = [&](std::size_t end) {
    return width_of(sheet, piece, text.substr(0, end), size) <= width;
  };
  std::size_t low = character_from(1);
  std::size_t high = character_from(kFirstLook);
  for (; fits(high); high = character_from(2 * high)) {
    low = high;
    if (low == text.size()) {
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

/// What stands between two blanks: more than one piece where the direction or the look changes within.
using Word = std::vector<PdfWord>;

/// Of runs that stand on the same lines, each piece measured.
std::vector<Word> words_of(const PdfSheet& sheet, std::span<const TextRun> runs, double size) {
  std::string whole;
  for (const TextRun& run : runs) {
    whole += run.text;
  }
  const std::vector<std::uint8_t> levels = bidi_levels(whole);
  std::vector<Word> words;
  bool joins = false;  // the next piece does
  std::uint8_t blank_level = 0;
  std::size_t at = 0;
  for (const TextRun& run : runs) {
    for (std::size_t in_run = 0; in_run < run.text.size();) {
      const CodePoint c = first_code_point(std::string_view(run.text).substr(in_run));
      const std::size_t bytes = std::max<std::size_t>(c.bytes, 1);
      const std::uint8_t level = levels[at];
      if (c.value == ' ') {
        joins = false;
        blank_level = level;
      } else if (!isolates(c.value)) {
        if (!joins) {
          words.emplace_back();
        }
        Word& word = words.back();
        if (!joins || word.back().level != level || word.back().bold != run.bold ||
            word.back().soft != run.soft) {
          word.push_back({{}, run.bold, run.soft, level, joins, blank_level});
        }
        joins = true;
        word.back().text.append(run.text, in_run, bytes);
      }
      in_run += bytes;
      at += bytes;
    }
  }
  for (Word& word : words) {
    for (PdfWord& piece : word) {
      piece.width = width_of(sheet, piece, piece.text, size);
    }
  }
  return words;
}

double blank_width(const PdfSheet& sheet, double size) {
  return sheet.text_width(" ", false, PdfFont::kPlain, size);
}

class Breaker {
 public:
  Breaker(const PdfSheet& sheet, double size, double width)
      : sheet_(sheet), size_(size), width_(width), blank_(blank_width(sheet, size)) {}

  void end_line() {
    if (!lines_.back().words.empty()) {
      lines_.emplace_back();
    }
  }

  void add(const Word& word) {
    double wide = 0;
    for (const PdfWord& piece : word) {
      wide += piece.width;
    }
    if (wide <= width_) {
      put(word, wide);
      return;
    }
    for (const PdfWord& piece : word) {
      bool joins = piece.joins;
      for (std::string_view rest = piece.text; !rest.empty();) {
        const std::size_t fits = fitting(sheet_, piece, rest, size_, width_);
        PdfWord part = piece;
        part.text = rest.substr(0, fits);
        part.width = width_of(sheet_, part, part.text, size_);
        part.joins = std::exchange(joins, true);
        const double part_width = part.width;
        put({std::move(part)}, part_width);
        rest.remove_prefix(fits);
      }
    }
  }

  PdfLines lines() { return std::move(lines_); }

 private:
  /// On this line, or the next where it has no room.
  void put(const Word& unbroken, double wide) {
    const double gap = lines_.back().words.empty() || unbroken.front().joins ? 0 : blank_;
    const bool next = !lines_.back().words.empty() && lines_.back().width + gap + wide > width_;
    if (next) {
      lines_.emplace_back();
    }
    lines_.back().width += (next ? 0 : gap) + wide;
    lines_.back().words.insert(lines_.back().words.end(), unbroken.begin(), unbroken.end());
  }

  const PdfSheet& sheet_;
  double size_;
  double width_;
  double blank_;
  PdfLines lines_ = PdfLines(1);
};

}  // namespace

PdfLines pdf_lines(const PdfSheet& sheet, const RichText& text, double size, double width) {
  Breaker breaker(sheet, size, width);
  for (auto from = text.begin(); from != text.end();) {
    const auto to = std::find_if(from + 1, text.end(), [](const TextRun& run) { return run.breaks; });
    if (from->breaks) {
      breaker.end_line();
    }
    for (const Word& word : words_of(sheet, {from, to}, size)) {
      breaker.add(word);
    }
    from = to;
  }
  return breaker.lines();
}

void draw_lines(PdfSheet& sheet, const PdfLines& lines, double left, double top, double size, double grey) {
  const double blank = blank_width(sheet, size);
  double y = top;
  for (const PdfLine& line : lines) {
    y -= kPdfLeading * size;
    std::vector<const PdfWord*> read;  // null: a blank
    std::vector<std::uint8_t> levels;
    for (const PdfWord& word : line.words) {
      if (!word.joins && !read.empty()) {
        read.push_back(nullptr);
        levels.push_back(word.blank_level);
      }
      read.push_back(&word);
      levels.push_back(word.level);
    }
    double x = left;
    for (const std::size_t k : seen_order(levels)) {
      if (const PdfWord* word = read[k]; word != nullptr) {
        sheet.text(word->text, is_leftwards(word->level), x, y, font_of(word->bold), size,
                   word->soft ? kPdfSoftGrey : grey);
      }
      x += read[k] == nullptr ? blank : read[k]->width;
    }
  }
}

double height_of(const PdfLines& lines, double size) {
  return kPdfLeading * size * static_cast<double>(lines.size());
}

std::vector<std::vector<PdfLines>> in_parts(const std::vector<PdfLines>& cells, std::size_t most_lines) {
  std::size_t lines = 1;
  for (const PdfLines& cell : cells) {
    lines = std::max(lines, cell.size());
  }
  const std::size_t step = std::max<std::size_t>(1, most_lines);
  std::vector<std::vector<PdfLines>> parts;
  for (std::size_t from = 0; from < lines; from += step) {
    std::vector<PdfLines>& part = parts.emplace_back();
    for (const PdfLines& cell : cells) {
      const auto at = [&](std::size_t line) {
        return cell.begin() + static_cast<std::ptrdiff_t>(std::min(line, cell.size()));
      };
      part.emplace_back(at(from), at(from + step));
    }
  }
  return parts;
}

}  // namespace dubsar
