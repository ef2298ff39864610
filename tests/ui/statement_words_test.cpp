// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/statement_words.h"

#include <gtest/gtest.h>
#include <imgui.h>

namespace dubsar::ui {
namespace {

/// Letters of a size, of a window that is never opened.
class StatementWordsIn : public ::testing::TestWithParam<float> {
 protected:
  void SetUp() override {
    ImGui::CreateContext();
    fonts_ = load_fonts(GetParam());
    ImGui::GetIO().Fonts->Build();
  }
  void TearDown() override { ImGui::DestroyContext(); }
  [[nodiscard]] float high_px(const ImFont* font, float letters_px, const std::string& text) const {
    return font->CalcTextSizeA(letters_px, 1e6F, kWidePx, text.c_str()).y;
  }
  static constexpr float kWidePx = 520, kWantedPx = 130, kMostPx = 300;
  Fonts fonts_;
};

TEST_P(StatementWordsIn, AreWholeHoweverMany) {
  Statement statement;
  statement.headline = "Die Rückseite zur Kamera drehen, 90°; dann Drehteller auf 40°, Neigung auf 52°";
  for (int words = 10; words < 160; words += 10) {
    statement.detail.clear();
    for (int k = 0; k < words; ++k) {
      statement.detail += "weiter ";
    }
    const StatementWords set = set_words(statement, fonts_, kWidePx, kWantedPx, kMostPx);
    EXPECT_GE(set.detail_at_px, high_px(fonts_.large, set.headline_px, statement.headline));
    EXPECT_GE(set.high_px, set.detail_at_px + high_px(fonts_.normal, set.detail_px, statement.detail));
    EXPECT_LE(set.high_px, kMostPx) << words;
  }
}

TEST_P(StatementWordsIn, AreLargeWhereTheyAreFew) {
  Statement statement;
  statement.headline = "Hands off";
  const StatementWords set = set_words(statement, fonts_, kWidePx, kWantedPx, kMostPx);
  EXPECT_EQ(set.headline_px, fonts_.large->FontSize);
  EXPECT_EQ(set.detail_px, fonts_.normal->FontSize);
}

INSTANTIATE_TEST_SUITE_P(Letters, StatementWordsIn,
                         ::testing::Values(kSmallestFontPx, 18.0F, 30.0F, kLargestFontPx));

}  // namespace
}  // namespace dubsar::ui
