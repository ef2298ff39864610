// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A picture that lies in a session and gets the words of its package.
#include "archive/png_text.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const dubsar::PictureWords words{
      .title = "K. 1", .description = "what it shows\nand more", .copyright = "\xC2\xA9 A Museum"};
  if (const auto once = dubsar::png_with_words(dubsar::fuzz::text_of(data, size), words)) {
    const auto twice = dubsar::png_with_words(*once, words);
    dubsar::fuzz::require(twice && *twice == *once);
    const auto without = dubsar::png_with_words(*once, {});
    dubsar::fuzz::require(without && without->size() <= size);
  }
  return 0;
}
