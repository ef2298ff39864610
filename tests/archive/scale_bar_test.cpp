// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/scale_bar.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "archive/glyphs.h"

namespace dubsar {
namespace {

TEST(ScaleBar, IsTenMillimetresOnATablet) {
  EXPECT_EQ(scale_bar_for(0.05, 1000).length_mm, 10.0);
  EXPECT_EQ(scale_bar_for(0.1, 1200).length_mm, 10.0);
}

TEST(ScaleBar, ChangesItsLengthForTinyAndHugeThings) {
  const ScaleBar tiny = scale_bar_for(0.002, 1000);  // 2 mm wide
  EXPECT_LT(tiny.length_mm, 1.01);
  EXPECT_GE(tiny.length_mm, 0.1);
  const ScaleBar huge = scale_bar_for(1.0, 1000);
  EXPECT_GE(huge.length_mm, 60.0);
  EXPECT_LE(huge.length_mm, 500.0);
}

TEST(ScaleBar, IsTheLongestRoundLengthThatSuitsATinyTablet) {
  EXPECT_EQ(scale_bar_for(0.025, 600).length_mm, 5.0);  // 15 mm wide
  EXPECT_EQ(scale_bar_for(0.02, 232).length_mm, 2.0);   // a place of the red map
  EXPECT_EQ(scale_bar_for(0.2, 1200).length_mm, 100.0);
  EXPECT_EQ(scale_bar_for(0.025, 600).text_scale, 2);
  EXPECT_EQ(scale_bar_for(0.025, 600, 4).text_scale, 4) << "of a picture that is shown half as large";
}

TEST(ScaleBar, IsAsLongAsItSays) {
  Image image = filled_image(600, 60, {255, 255, 255});
  image.mm_per_px = 0.05;
  const ScaleBar bar = scale_bar_for(image.mm_per_px, 600);
  draw_scale_bar(image, bar, 20, 10, {0, 0, 0});
  const int row = 10 + 2 * bar.text_scale;  // the line along the top of the bar
  EXPECT_EQ(image.rgb(19, row), (Rgb8{255, 255, 255}));
  int length = 0;
  while (image.rgb(20 + length, row) == Rgb8{0, 0, 0}) {
    ++length;
  }
  EXPECT_EQ(length, 200);
}

TEST(ScaleBar, DoesNothingWithoutAScale) {
  Image image = filled_image(50, 50, {9, 9, 9});
  draw_scale_bar(image, scale_bar_for(0, 50), 0, 0, {255, 0, 0});
  EXPECT_EQ(image.bytes, filled_image(50, 50, {9, 9, 9}).bytes);
}

TEST(ScaleBar, StandsBelowThePicture) {
  Image picture = filled_image(600, 40, {200, 180, 160});
  picture.mm_per_px = 25.4 / 600;
  const Rgb8 black{0, 0, 0};
  const Image ruled = with_scale_bar(picture, black);
  ASSERT_EQ(ruled.width, 600);
  ASSERT_EQ(ruled.height, 40 + 72) << "as docs/frames-and-units.md says";
  EXPECT_EQ(ruled.mm_per_px, picture.mm_per_px);
  EXPECT_TRUE(std::equal(picture.bytes.begin(), picture.bytes.end(), ruled.bytes.begin()));
  int longest = 0;
  for (int y = 40; y < ruled.height; ++y) {
    int run = 0;
    for (int x = 0; x < 600; ++x) {
      run = ruled.rgb(x, y) != black ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_EQ(longest, 236) << "10 mm";
  for (int x = 0; x < 600; ++x) {
    EXPECT_EQ(ruled.rgb(x, 40), black) << "air";
    EXPECT_EQ(ruled.rgb(x, ruled.height - 1), black);
  }
}

TEST(ScaleBar, ANarrowPictureHasSmallerWordsOrNone) {
  for (const int width : {600, 150, 60, 20, 1}) {
    Image picture = filled_image(width, 5, {255, 255, 255});
    picture.mm_per_px = 25.4 / 600;
    const Image ruled = with_scale_bar(picture, {255, 255, 255});
    EXPECT_EQ(ruled.width, width);
    EXPECT_EQ(ruled.height, 5 + 72);
    const bool inked = std::ranges::any_of(ruled.bytes, [](std::uint8_t sample) { return sample != 255; });
    EXPECT_EQ(inked, width >= 60) << width;
  }
  EXPECT_EQ(with_scale_bar(filled_image(9, 9, {1, 2, 3}), {0, 0, 0}).height, 9) << "not to scale";
}

TEST(Glyphs, DrawInsideThePictureOnly) {
  Image image = filled_image(12, 9, {0, 0, 0});
  draw_text(image, -3, -2, "10 mm\xC3\x9F", {255, 255, 255}, 3);
  draw_text(image, 8, 5, "Wq", {255, 255, 255}, 2);
  EXPECT_EQ(image.bytes.size(), 12U * 9U * 3U);
  EXPECT_EQ(text_width("10 mm"), 29);
  EXPECT_EQ(text_width(""), 0);
}

TEST(Glyphs, OneLooksLikeAOne) {
  Image image = filled_image(5, 7, {0, 0, 0});
  draw_text(image, 0, 0, "1", {255, 255, 255});
  std::string art;
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 5; ++x) {
      art += image.rgb(x, y)[0] != 0 ? '#' : '.';
    }
  }
  EXPECT_EQ(art, "..#...##....#....#....#....#...###.");
}

}  // namespace
}  // namespace dubsar
