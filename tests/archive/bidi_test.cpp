// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/bidi.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace dubsar {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::uint8_t level_at(const std::string& text, std::string_view piece) {
  return bidi_levels(text).at(text.find(piece));
}

TEST(Bidi, LettersGoTheirWayAndFiguresTheirs) {
  const std::string text = "IM متحف 12 x";
  EXPECT_EQ(level_at(text, "IM"), 0);
  EXPECT_TRUE(is_leftwards(level_at(text, "متحف")));
  EXPECT_EQ(level_at(text, "12"), 2) << "to the right, within what goes to the left";
  EXPECT_EQ(level_at(text, "x"), 0);
  EXPECT_EQ(bidi_levels(text).size(), text.size()) << "one a byte";
}

TEST(Bidi, AParagraphGoesTheWayOfItsFirstLetter) {
  EXPECT_EQ(level_at("(IM) متحف.", "."), 0);
  EXPECT_EQ(level_at("(متحف) IM.", "."), 1);
  EXPECT_THAT(bidi_levels("12 - 13"), Each(0));
}

TEST(Bidi, WhatIsIsolatedDrawsNoFiguresIn) {
  EXPECT_EQ(level_at("A متحف, 2026", "2026"), 2);
  EXPECT_EQ(level_at("A " + isolated("متحف") + ", 2026", "2026"), 0);
}

TEST(Bidi, TakesAnyBytes) {
  EXPECT_THAT(bidi_levels(""), IsEmpty());
  EXPECT_EQ(bidi_levels("\xFF\xD9").size(), 2U);
  std::string deep;
  for (int i = 0; i < 1000; ++i) {
    deep += "\xE2\x81\xA7(";  // U+2067: to the left
  }
  EXPECT_EQ(bidi_levels(deep).size(), deep.size());
}

TEST(Bidi, PiecesAreSeenFromTheLeft) {
  const auto order = [](std::vector<std::uint8_t> levels) { return seen_order(levels); };
  EXPECT_THAT(order({}), IsEmpty());
  EXPECT_THAT(order({0, 0, 0}), ElementsAre(0, 1, 2));
  EXPECT_THAT(order({0, 1, 1, 0}), ElementsAre(0, 2, 1, 3));
  EXPECT_THAT(order({1, 1, 2, 2, 1}), ElementsAre(4, 2, 3, 1, 0));
}

}  // namespace
}  // namespace dubsar
