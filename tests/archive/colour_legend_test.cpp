// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/colour_legend.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace dubsar {
namespace {

constexpr Rgb8 kBlack{0, 0, 0};
constexpr Rgb8 kInk{255, 255, 255};
constexpr Rgb8 kLow{40, 30, 90};
constexpr Rgb8 kHigh{250, 230, 60};

/// The first and the last column that has this colour; -1: none has.
std::pair<int, int> columns_of(const Image& image, Rgb8 colour) {
  std::pair<int, int> out{-1, -1};
  for (int x = 0; x < image.width; ++x) {
    for (int y = 0; y < image.height; ++y) {
      if (image.rgb(x, y) == colour) {
        out = {out.first < 0 ? x : out.first, x};
      }
    }
  }
  return out;
}

TEST(ColourLegend, HasTheColoursFromTheLowestToTheHighestBetweenTheirNumbers) {
  Image image = filled_image(600, 80, kBlack);
  draw_colour_legend(image, {"Height, mm", {kLow, kHigh}, -0.5, 0.5, {}}, 10, 8, 2, kInk);
  const auto [low_first, low_last] = columns_of(image, kLow);
  const auto [high_first, high_last] = columns_of(image, kHigh);
  const auto [ink_first, ink_last] = columns_of(image, kInk);
  ASSERT_GT(low_first, 0);
  EXPECT_EQ(high_first, low_last + 1);
  EXPECT_LT(ink_first, low_first);
  EXPECT_GT(ink_last, high_last);
  EXPECT_GE(ink_first, 10);
}

TEST(ColourLegend, OfColoursThatAreWordsHasABoxForEach) {
  Image image = filled_image(600, 80, kBlack);
  draw_colour_legend(image, {"Flags", {}, 0, 0, {{"sparse", kLow}, {"filled", kHigh}}}, 10, 8, 2, kInk);
  EXPECT_GT(columns_of(image, kLow).first, 0);
  EXPECT_GT(columns_of(image, kHigh).first, columns_of(image, kLow).second);
}

TEST(ColourLegend, IsSmallerWhereThePictureIsNarrow) {
  const ColourLegend legend{"Height, mm", {kLow, kHigh}, -0.5, 0.5, {}};
  Image image = filled_image(300, 160, kBlack);
  draw_colour_legend(image, legend, 10, 8, 6, kInk);
  EXPECT_LT(columns_of(image, kInk).second, 290);
  EXPECT_GT(columns_of(image, kInk).second, columns_of(image, kHigh).second) << "its last number is whole";
  Image tiny = filled_image(20, 5, kBlack);
  draw_colour_legend(tiny, legend, 10, 2, 6, kInk);  // what lies outside is cut off
}

}  // namespace
}  // namespace dubsar
