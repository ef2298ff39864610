// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The pages that a session keeps are its own, but a session comes from outside like any other file.
#include "archive/page_blocks.h"

#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using dubsar::fuzz::require;
  std::size_t characters = 0;
  const auto count = [&](const dubsar::RichText& text) {
    for (const dubsar::TextRun& run : text) {
      characters += run.text.size();
    }
  };
  for (const dubsar::PageBlock& block : dubsar::page_blocks(dubsar::fuzz::text_of(data, size))) {
    require(block.level >= 0 && block.level <= 3);
    count(block.text);
    for (const auto& row : block.rows) {
      for (const dubsar::RichText& cell : row) {
        count(cell);
      }
    }
    for (const dubsar::PageFigure& figure : block.figures) {
      require(figure.width_px >= 0 && figure.height_px >= 0);
      require(std::isfinite(figure.width_mm) && figure.width_mm >= 0);
      require(figure.png.size() <= size);
      count(figure.caption);
    }
  }
  // A legend's colours become words, nothing else is added: no page grows without bound.
  require(characters <= 8 * size);
  return 0;
}
