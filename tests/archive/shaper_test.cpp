// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/shaper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Shaping : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(font_) << "install fonts-dejavu-core (packages.txt)"; }

  static std::vector<std::string> texts(const ShapedText& shaped) {
    std::vector<std::string> all;
    for (const ShapedGlyph& glyph : shaped.glyphs) {
      all.push_back(glyph.text);
    }
    return all;
  }

  std::optional<Shaper> font_ = Shaper::open("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf");
};

TEST_F(Shaping, LettersStandFromLeftToRight) {
  const ShapedText word = font_->shape("ab", false);
  EXPECT_THAT(texts(word), ElementsAre("a", "b"));
  EXPECT_EQ(word.glyphs[0].x, 0);
  EXPECT_GT(word.glyphs[1].x, 0.5);
  EXPECT_GT(word.width, word.glyphs[1].x);
}

TEST_F(Shaping, ArabicLettersAreJoinedAndGoToTheLeft) {
  const ShapedText word = font_->shape("بتب", true);
  EXPECT_THAT(texts(word), ElementsAre("ب", "ت", "ب"));
  const std::uint32_t alone = font_->shape("ب", true).glyphs.at(0).index;
  EXPECT_NE(word.glyphs[2].index, alone) << "the first letter, at the right, reaches to the next";
  EXPECT_NE(word.glyphs[0].index, word.glyphs[2].index) << "the last one ends the word";
  EXPECT_LT(word.width, 3 * font_->shape("ب", true).width);
}

TEST_F(Shaping, LamAndAlifAreOneForm) {
  EXPECT_THAT(texts(font_->shape("لا", true)), ElementsAre("لا"));
  EXPECT_THAT(texts(font_->shape("ffi", false)), ElementsAre("f", "f", "i")) << "which need not be joined";
}

TEST_F(Shaping, MarksTakeNoRoomAndTellThemselves) {
  EXPECT_DOUBLE_EQ(font_->shape("שָׁם", true).width, font_->shape("שם", true).width);
  EXPECT_THAT(texts(font_->shape("שָׁ", true)), ::testing::UnorderedElementsAre("ש", "ָ", "ׁ"));
  EXPECT_TRUE(is_mark(0x5B8));
  EXPECT_FALSE(is_mark('a'));
}

TEST_F(Shaping, ABracketOfTextToTheLeftIsItsCounterpart) {
  const ShapedText opens = font_->shape("(", true);
  EXPECT_EQ(opens.glyphs.at(0).index, font_->shape(")", false).glyphs.at(0).index);
  EXPECT_THAT(texts(opens), ElementsAre(")")) << "else it would be told as both";
}

TEST_F(Shaping, ScriptsOfOneDirectionStandBesideEachOther) {
  EXPECT_THAT(texts(font_->shape("אب1", true)), ElementsAre("1", "ب", "א"));
  EXPECT_THAT(texts(font_->shape("aяα", false)), ElementsAre("a", "я", "α"));
}

TEST_F(Shaping, TakesNothingForAText) {
  EXPECT_THAT(font_->shape("", true).glyphs, IsEmpty());
  EXPECT_EQ(font_->shape("", false).width, 0);
}

TEST_F(Shaping, KnowsWhatTheFontHas) {
  EXPECT_TRUE(font_->has(0x1E2B));    // ḫ
  EXPECT_FALSE(font_->has(0x12000));  // a sign of cuneiform
}

TEST(Shaper, TakesNoOtherFileForAFont) {
  EXPECT_FALSE(Shaper::open("/etc/passwd"));
  EXPECT_FALSE(Shaper::open("/no/such/file"));
}

}  // namespace
}  // namespace dubsar
