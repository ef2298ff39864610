// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/setting_words.h"

namespace dubsar {
namespace {

/// A stripe of that height over a background of 5, along the rows or the columns; its right part as `other`.
GrayImage stripe(double height, double other, double share_of_other, bool upright) {
  GrayImage image(upright ? 120 : 200, upright ? 200 : 120);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const int along = upright ? v : u;
      const int across = upright ? u : v;
      const double tall = along < 200 * (1 - share_of_other) ? height : other;
      const double grey = 5 + tall * std::exp(-0.5 * std::pow((across - 60) / 2.0, 2));
      image.pixels[image.index(u, v)] = static_cast<std::uint8_t>(std::min(255.0, grey));
    }
  }
  return image;
}

TEST(Exposure, ToldByTheStripeWhicheverWayItRuns) {
  for (const bool upright : {false, true}) {
    const Exposure good = judge_exposure(stripe(150, 150, 0, upright).view());
    EXPECT_TRUE(good.has_stripe);
    EXPECT_EQ(good.advice, ExposureAdvice::kGood);
    EXPECT_EQ(good.saturated_share, 0);
    const Exposure lit = judge_exposure(stripe(150, 400, 0.25, upright).view());
    EXPECT_EQ(lit.advice, ExposureAdvice::kTooLong);
    EXPECT_NEAR(lit.saturated_share, 0.25, 1e-9);
    const Exposure weak = judge_exposure(stripe(150, 25, 0.5, upright).view());
    EXPECT_EQ(weak.advice, ExposureAdvice::kTooShort);
    EXPECT_NEAR(weak.dark_share, 0.5, 1e-9);
  }
}

TEST(Exposure, AGlintIsNoFault) {
  const Exposure is = judge_exposure(stripe(150, 400, 0.01, false).view());
  EXPECT_EQ(is.advice, ExposureAdvice::kGood);
  EXPECT_GT(is.saturated_share, 0);
}

TEST(Exposure, AFrameWithoutAStripeIsAPhotograph) {
  GrayImage image(100, 80);
  const auto fill = [&](auto grey_at) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      image.pixels[i] = static_cast<std::uint8_t>(grey_at(i));
    }
    return judge_exposure(image.view());
  };
  EXPECT_EQ(fill([](std::size_t) { return 3; }).advice, ExposureAdvice::kTooShort);
  const Exposure board = fill([](std::size_t i) { return (i / 10) % 2 == 0 ? 40 : 200; });
  EXPECT_FALSE(board.has_stripe);
  EXPECT_EQ(board.advice, ExposureAdvice::kGood);
  EXPECT_EQ(fill([](std::size_t i) { return (i / 10) % 2 == 0 ? 40 : 255; }).advice,
            ExposureAdvice::kTooLong);
  EXPECT_EQ(judge_exposure(GrayView{}).advice, ExposureAdvice::kGood);
}

TEST(Exposure, MarksAreWhereTheFaultIs) {
  const GrayImage image = stripe(25, 400, 0.5, false);
  std::vector<PixelMark> marks;
  const Exposure is = judge_exposure(image.view(), &marks);
  ASSERT_EQ(marks.size(), image.pixels.size());
  EXPECT_TRUE(is.has_stripe);
  EXPECT_EQ(marks[image.index(20, 60)], PixelMark::kDark);
  EXPECT_EQ(marks[image.index(180, 60)], PixelMark::kSaturated);
  EXPECT_EQ(marks[image.index(20, 20)], PixelMark::kPlain);
  EXPECT_EQ(marks[image.index(180, 20)], PixelMark::kPlain);
}

TEST(SettingWords, AreReadAsTheSettingIsAndBack) {
  const auto of = [](SettingType type) {
    SettingInfo info;
    info.key = "k";
    info.type = type;
    return info;
  };
  for (const auto& [type, word] :
       {std::pair(SettingType::kBool, "true"), std::pair(SettingType::kInteger, "-12"),
        std::pair(SettingType::kNumber, "0.125"), std::pair(SettingType::kText, ""),
        std::pair(SettingType::kChoice, "free")}) {
    const Result<SettingValue> value = setting_value(of(type), word, "here");
    ASSERT_TRUE(value.has_value()) << word;
    EXPECT_EQ(setting_word(*value), word);
  }
  for (const auto& [type, word] :
       {std::pair(SettingType::kBool, "yes"), std::pair(SettingType::kInteger, "1.5"),
        std::pair(SettingType::kNumber, ""), std::pair(SettingType::kNumber, "1e999"),
        std::pair(SettingType::kInteger, "99999999999999999999")}) {
    const Result<SettingValue> value = setting_value(of(type), word, "here");
    ASSERT_FALSE(value.has_value()) << word;
    EXPECT_EQ(value.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace dubsar
