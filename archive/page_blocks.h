// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dubsar {

/// Text of one kind. UTF-8, without markup, blanks drawn together.
struct TextRun {
  std::string text;
  bool bold = false;
  bool soft = false;    ///< an aside: smaller and greyer
  bool breaks = false;  ///< a new line begins before it
};
using RichText = std::vector<TextRun>;

struct PageFigure {
  std::string png;  ///< the file's bytes
  int width_px = 0;
  int height_px = 0;
  double width_mm = 0;  ///< of what is shown; 0: not to scale
  RichText caption;
};

/// What a page of ours is made of, one after the other.
struct PageBlock {
  enum class Kind {
    kHeading,     ///< text, level 1 to 3
    kParagraph,   ///< text; level 1: below a line to write on
    kItem,        ///< text after `mark`
    kDefinition,  ///< text after the term `mark`
    kTable,       ///< cells by row; the first row is the head
    kFigures,     ///< figures, all alike
    kCross,       ///< the six views, in the order of kSixViewOrder, laid out as a cross and to scale;
                  ///< text: how long the bar beside them is, of the tablet, such as "5 mm"
  };
  Kind kind = Kind::kParagraph;
  int level = 0;
  std::string mark;
  RichText text;
  std::vector<std::vector<RichText>> rows;
  std::vector<PageFigure> figures;
};

/// Takes a page apart that archive/report.h has made, so that it can be set in another form with the very
/// same words. Knows the elements that those pages use and no others: whatever else comes is passed over.
[[nodiscard]] std::vector<PageBlock> page_blocks(std::string_view html);

}  // namespace dubsar
