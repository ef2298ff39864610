// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/png_text.h"

#include <gtest/gtest.h>

#include "archive/png.h"

namespace dubsar {
namespace {

std::string png_of(const PictureWords& words) {
  Image image = filled_image(31, 17, {10, 200, 30});
  image.mm_per_px = 0.05;
  const auto bytes = encode_png(image, words);
  return bytes ? std::string(bytes->begin(), bytes->end()) : std::string();
}

TEST(PngText, IsThePictureThatWasMadeWithThoseWords) {
  const PictureWords plain{.title = "K. 1", .description = "one\ntwo", .copyright = "(c) A"};
  const PictureWords more{.title = "Ḫattuša", .description = "größer", .copyright = "© A"};
  for (const PictureWords& before : {PictureWords{}, plain, more}) {
    for (const PictureWords& after : {PictureWords{}, plain, more}) {
      EXPECT_TRUE(png_with_words(png_of(before), after).value() == png_of(after))
          << before.title << " to " << after.title;
    }
  }
}

TEST(PngText, RefusesWhatIsNoPng) {
  const std::string whole = png_of({.title = "K. 1"});
  for (std::size_t bytes = 0; bytes < whole.find("IDAT"); ++bytes) {
    EXPECT_FALSE(png_with_words(std::string_view(whole).substr(0, bytes), {})) << bytes;
  }
  std::string longer = whole;
  longer[8] = '\xFF';  // of the first chunk's length
  EXPECT_EQ(png_with_words(longer, {}).error().kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace dubsar
