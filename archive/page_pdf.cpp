// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/page_pdf.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "archive/bidi.h"
#include "archive/cross_plan.h"
#include "archive/page_blocks.h"
#include "archive/pdf_lines.h"
#include "archive/print_scale.h"

namespace dubsar {

namespace {

constexpr double kMargin = 15 * kPointsPerMm;
constexpr double kFoot = 20 * kPointsPerMm;
constexpr double kColumn = PdfSheet::kWidth - 2 * kMargin;
constexpr double kBody = 9.0;
constexpr std::array<double, 4> kHeading = {kBody, 17, 12.5, 10};

std::string words_of(const RichText& text) {
  std::string words;
  for (const TextRun& run : text) {
    words += run.text;
  }
  return words;
}

/// Of "5 mm"; 0 where it says something else.
double millimetres_in(std::string_view words) {
  double mm = 0;
  const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), mm);
  const std::string_view unit = words.substr(static_cast<std::size_t>(end - words.data()));
  return error == std::errc() && unit == " mm" && std::isfinite(mm) ? mm : 0;
}

class Setter {
 public:
  Setter(PdfSheet& sheet, std::string foot) : sheet_(sheet), foot_(std::move(foot)) {}

  void finish() {
    const std::string foot = foot_ + ", page " + std::to_string(sheet_.pages());
    one_line(foot, kMargin, 0.5 * kFoot, 6.5);
  }

  /// next: what follows, or null.
  void set(const PageBlock& block, const PageBlock* next) {
    switch (block.kind) {
      case PageBlock::Kind::kHeading:
        heading(block, next);
        break;
      case PageBlock::Kind::kParagraph:
        if (block.level > 0) {
          room_for(5 * kBody);
          y_ -= 3 * kBody;  // to write on
          sheet_.line(kMargin, y_, kMargin + 0.5 * kColumn, y_, 0.5, 0);
        }
        paragraph(block.text, 0);
        y_ -= 0.45 * kBody;
        break;
      case PageBlock::Kind::kItem:
        marked(block, 14);
        break;
      case PageBlock::Kind::kDefinition:
        marked(block, 135);
        break;
      case PageBlock::Kind::kTable:
        table(block.rows);
        break;
      case PageBlock::Kind::kFigures:
        figures(block.figures);
        break;
      case PageBlock::Kind::kCross:
        cross(block);
        break;
    }
  }

 private:
  /// Plain and grey, its baseline at y.
  void one_line(const std::string& words, double x, double y, double size) {
    const PdfLines line = pdf_lines(sheet_, {{.text = words, .soft = true}}, size, kPdfOneLine);
    draw_lines(sheet_, line, x, y + kPdfLeading * size, size, kPdfSoftGrey);
  }

  void room_for(double height) {
    if (y_ - height < kFoot) {
      finish();
      sheet_.new_page();
      y_ = PdfSheet::kHeight - kMargin;
    }
  }

  /// What has to stand on the heading's page of that which follows it.
  double least_height(const PageBlock* next) {
    if (next != nullptr && next->kind == PageBlock::Kind::kFigures && !next->figures.empty()) {
      return measured(next->figures, 0).high;
    }
    if (next != nullptr && next->kind == PageBlock::Kind::kCross && next->figures.size() == 6) {
      const CrossPlan plan = cross_plan(next->figures, kColumn / kPointsPerMm);
      return plan.all_high_mm * plan.unit;
    }
    return 5 * kPdfLeading * kBody;
  }

  void heading(const PageBlock& block, const PageBlock* next) {
    const double size = kHeading[static_cast<std::size_t>(std::clamp(block.level, 1, 3))];
    RichText text = block.text;
    for (TextRun& run : text) {
      run.bold = true;
    }
    const auto lines = pdf_lines(sheet_, text, size, kColumn);
    room_for(height_of(lines, size) + size + least_height(next));  // never alone at the foot
    y_ -= 0.6 * size;
    sheet_.bookmark(words_of(block.text), y_ + size, block.level);
    draw_lines(sheet_, lines, kMargin, y_, size, 0);
    y_ -= height_of(lines, size) + 0.35 * size;
  }

  /// Line by line, so that it may go on over the page.
  void paragraph(const RichText& text, double indent) {
    for (const PdfLine& line : pdf_lines(sheet_, text, kBody, kColumn - indent)) {
      room_for(kPdfLeading * kBody);
      draw_lines(sheet_, {line}, kMargin + indent, y_, kBody, 0);
      y_ -= kPdfLeading * kBody;
    }
  }

  void marked(const PageBlock& block, double indent) {
    room_for(kPdfLeading * kBody);
    one_line(block.mark, kMargin, y_ - kPdfLeading * kBody, kBody);
    paragraph(block.text, indent);
    y_ -= 0.2 * kBody;
  }

  void table(const std::vector<std::vector<RichText>>& rows) {
    constexpr double kSize = 7.2;
    constexpr double kGap = 7;
    std::size_t columns = 0;
    for (const auto& row : rows) {
      columns = std::max(columns, row.size());
    }
    if (columns == 0) {
      return;
    }
    const std::vector<double> widths = column_widths(rows, columns, kSize, kGap);
    const auto height = [&](const std::vector<PdfLines>& cells) {
      double most = kPdfLeading * kSize;
      for (const auto& cell : cells) {
        most = std::max(most, height_of(cell, kSize));
      }
      return most + 3;
    };
    const auto broken = [&](const std::vector<RichText>& row, bool head) {
      std::vector<PdfLines> cells;
      for (std::size_t c = 0; c < row.size(); ++c) {
        RichText text = row[c];
        for (TextRun& run : text) {
          run.bold = run.bold || head;
        }
        cells.push_back(pdf_lines(sheet_, text, kSize, widths[c]));
      }
      return cells;
    };
    const auto put = [&](const std::vector<PdfLines>& cells, bool head) {
      double x = kMargin;
      for (std::size_t c = 0; c < cells.size(); ++c) {
        draw_lines(sheet_, cells[c], x, y_, kSize, 0);
        x += widths[c] + kGap;
      }
      y_ -= height(cells);
      sheet_.line(kMargin, y_, kMargin + kColumn, y_, head ? 0.6 : 0.2, head ? 0 : 0.6);
    };
    const auto head = broken(rows.front(), true);
    room_for(4 * height(head));
    put(head, true);
    const double room = PdfSheet::kHeight - kMargin - kFoot - height(head) - 3;  // a page's
    const auto most_lines = static_cast<std::size_t>(std::max(1.0, room / (kPdfLeading * kSize)));
    for (std::size_t r = 1; r < rows.size(); ++r) {
      for (const auto& cells : in_parts(broken(rows[r], false), most_lines)) {
        const int page = sheet_.pages();
        room_for(height(cells));
        if (sheet_.pages() != page) {
          put(head, true);  // again on the new page
        }
        put(cells, false);
      }
    }
    y_ -= kBody;
  }

  /// As wide as their text where there is room; else the widest share what the others leave.
  std::vector<double> column_widths(const std::vector<std::vector<RichText>>& rows, std::size_t columns,
                                    double size, double gap) {
    std::vector<double> widths(columns, 0.0);
    for (const auto& row : rows) {
      for (std::size_t c = 0; c < row.size(); ++c) {
        RichText text = row[c];
        for (TextRun& run : text) {
          run.bold = run.bold || &row == &rows.front();
        }
        for (const PdfLine& line : pdf_lines(sheet_, text, size, kPdfOneLine)) {
          widths[c] = std::max(widths[c], line.width + 1);
        }
      }
    }
    const double room = kColumn - gap * static_cast<double>(columns - 1);
    // The highest level at which cutting all wider columns down to it makes them fit.
    double low = 0;
    double high = room;
    for (int step = 0; step < 40; ++step) {
      const double level = 0.5 * (low + high);
      double sum = 0;
      for (const double w : widths) {
        sum += std::min(w, level);
      }
      (sum <= room ? low : high) = level;
    }
    for (double& w : widths) {
      w = std::min(w, low);
    }
    return widths;
  }

  static constexpr double kFigureGap = 10;

  /// Figures beside each other, from `first` on.
  struct FigureRow {
    std::size_t across = 1;  ///< that have room beside each other
    double width = 0;        ///< of each, with what is free beside it
    double size = 0;         ///< of the captions
    double high = 0;
    std::vector<PdfLines> captions;
    std::vector<std::array<double, 2>> sizes;
  };

  FigureRow measured(const std::vector<PageFigure>& all, std::size_t first) {
    FigureRow row;
    const bool alone = all.size() == 1 && !(all.front().width_px < 500);
    row.across = alone ? 1 : 4;
    const auto across = static_cast<double>(row.across);
    row.width = (kColumn - kFigureGap * (across - 1)) / across;
    row.size = alone ? kBody : 6.8;
    for (std::size_t k = first; k < std::min(first + row.across, all.size()); ++k) {
      row.captions.push_back(pdf_lines(sheet_, all[k].caption, row.size, row.width));
      const double shape = static_cast<double>(all[k].height_px) / std::max(1, all[k].width_px);
      constexpr double kHighest = 215 * kPointsPerMm;
      const double wide = std::min(row.width, kHighest / std::max(shape, 1e-3));
      row.sizes.push_back({wide, wide * shape});
      row.high = std::max(row.high, row.sizes.back()[1] + height_of(row.captions.back(), row.size) + 4);
    }
    return row;
  }

  void figures(const std::vector<PageFigure>& all) {
    for (std::size_t first = 0; first < all.size();) {
      const FigureRow row = measured(all, first);
      room_for(row.high);
      for (std::size_t k = 0; k < row.sizes.size(); ++k) {
        const auto& [wide, tall] = row.sizes[k];
        const double x = kMargin + static_cast<double>(k) * (row.width + kFigureGap);
        sheet_.picture(all[first + k].png, x + 0.5 * (row.width - wide), y_ - tall, wide, tall);
        draw_lines(sheet_, row.captions[k], x, y_ - tall - 2, row.size, kPdfSoftGrey);
      }
      y_ -= row.high + kFigureGap;
      first += row.across;
    }
  }

  /// In the order top, left, obverse, right, bottom, reverse.
  void cross(const PageBlock& block) {
    const std::vector<PageFigure>& six = block.figures;
    if (six.size() != 6) {
      figures(six);
      return;
    }
    const auto [column_mm, middle_mm, all_wide_mm, all_high_mm, unit] =
        cross_plan(six, kColumn / kPointsPerMm);
    constexpr double kGapMm = CrossPlan::kGapMm;
    const auto wide_mm = [&](std::size_t k) { return six[k].width_mm; };
    const auto high_mm = [&](std::size_t k) { return height_mm(six[k]); };
    room_for(all_high_mm * unit);
    const double left = kMargin + 0.5 * (kColumn - all_wide_mm * unit);
    const double middle = left + (wide_mm(1) + kGapMm + 0.5 * column_mm) * unit;
    const auto put = [&](std::size_t k, double x, double top) {
      sheet_.picture(six[k].png, x, top - high_mm(k) * unit, wide_mm(k) * unit, high_mm(k) * unit);
    };
    const auto centred = [&](std::size_t k, double top) { put(k, middle - 0.5 * wide_mm(k) * unit, top); };
    double top = y_;
    centred(0, top);
    top -= (high_mm(0) + kGapMm) * unit;
    const auto beside = [&](std::size_t k) { return top - 0.5 * (middle_mm - high_mm(k)) * unit; };
    put(1, left, beside(1));
    centred(2, beside(2));
    put(3, left + (wide_mm(1) + column_mm + 2 * kGapMm) * unit, beside(3));
    top -= (middle_mm + kGapMm) * unit;
    centred(4, top);
    top -= (high_mm(4) + kGapMm) * unit;
    centred(5, top);
    const std::string words = words_of(block.text);
    if (const double bar_mm = millimetres_in(words);
        bar_mm > 0 && bar_mm <= all_wide_mm) {  // beside the reverse
      const double bar = middle + (0.5 * column_mm + kGapMm) * unit;
      const double bar_y = y_ - all_high_mm * unit + 8;
      sheet_.line(bar, bar_y, bar + bar_mm * unit, bar_y, 1.2, 0);
      one_line(words, bar, bar_y - 8, 6.5);
    }
    y_ -= all_high_mm * unit + kBody;
  }

  PdfSheet& sheet_;
  std::string foot_;
  double y_ = PdfSheet::kHeight - kMargin;
};

void spell(const PdfSheet& sheet, RichText& text) {
  for (TextRun& run : text) {
    run.text = sheet.spelt(run.text);
  }
}

void spell(const PdfSheet& sheet, PageBlock& block) {
  spell(sheet, block.text);
  block.mark = sheet.spelt(block.mark);
  for (auto& row : block.rows) {
    for (RichText& cell : row) {
      spell(sheet, cell);
    }
  }
  for (PageFigure& figure : block.figures) {
    spell(sheet, figure.caption);
  }
}

/// The page tells how large its six sides are where it is printed itself. Here they are as large as there is
/// room for on one sheet, which high ones are not at life size.
void tell_scale(const PageBlock& cross, PageBlock& below) {
  if (cross.figures.size() != 6) {
    return;
  }
  const double scale = cross_plan(cross.figures, kColumn / kPointsPerMm).unit / kPointsPerMm;
  for (TextRun& run : below.text) {
    const std::size_t from = run.text.find(kPrintedWords);
    const std::size_t stop = from == std::string::npos ? from : run.text.find('.', from);
    if (stop != std::string::npos) {
      run.text.replace(from, stop + 1 - from, printed_words(scale));
    }
  }
}

/// When the page says that it was made: what is packed later is that page still. Else the document's date.
std::string made(std::string_view html, const PdfInfo& info) {
  constexpr std::string_view kBefore = "<dt>Made</dt><dd>";
  const std::size_t before = html.find(kBefore);
  const std::size_t from = before == std::string_view::npos ? before : before + kBefore.size();
  const std::size_t to = before == std::string_view::npos ? before : html.find('<', from);
  return to == std::string_view::npos ? info.when : std::string(html.substr(from, to - from));
}

}  // namespace

Result<std::vector<std::uint8_t>> page_pdf(std::string_view html, const PdfInfo& info) {
  Result<PdfSheet> sheet = PdfSheet::make(info);
  if (!sheet) {
    return std::unexpected(sheet.error());
  }
  // The figures of the date beside those of an Arabic title are no part of it.
  Setter setter(*sheet, isolated(sheet->spelt(info.title)) + ", " + sheet->spelt(made(html, info)));
  std::vector<PageBlock> blocks = page_blocks(html);
  for (PageBlock& block : blocks) {
    spell(*sheet, block);
  }
  for (std::size_t k = 0; k + 1 < blocks.size(); ++k) {
    if (blocks[k].kind == PageBlock::Kind::kCross) {
      tell_scale(blocks[k], blocks[k + 1]);
    }
  }
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    setter.set(blocks[k], k + 1 < blocks.size() ? &blocks[k + 1] : nullptr);
  }
  setter.finish();
  return sheet->bytes();
}

}  // namespace dubsar
