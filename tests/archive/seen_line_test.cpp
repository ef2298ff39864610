// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/seen_line.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(SeenLine, LatinStaysAsItIs) {
  EXPECT_EQ(seen_line("VAT 1, ḫi.a (°)"), "VAT 1, ḫi.a (°)");
  EXPECT_EQ(seen_line(""), "");
  EXPECT_EQ(seen_line("\xFF\xFE"), "\xFF\xFE") << "no UTF-8";
}

TEST(SeenLine, HebrewRunsFromRightToLeftAndItsNumbersDoNot) {
  EXPECT_EQ(seen_line("\u05D0\u05D1 12"), "12 \u05D1\u05D0");
  EXPECT_EQ(seen_line("Tablet: \u05D0\u05D1 x"), "Tablet: \u05D1\u05D0 x");
  EXPECT_EQ(seen_line("\u05D0(\u05D1)"), "(\u05D1)\u05D0") << "brackets are mirrored";
}

/// BEH, YEH, TEH: the first, the middle and the last form, from the right.
TEST(SeenLine, ArabicLettersAreJoined) {
  EXPECT_EQ(seen_line("\u0628\u064A\u062A"), "\uFE96\uFEF4\uFE91");
  EXPECT_EQ(seen_line("\u0644\u0627"), "\uFEFB") << "lam and alif are one letter";
}

}  // namespace
}  // namespace dubsar
