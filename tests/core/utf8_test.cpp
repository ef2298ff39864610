// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/utf8.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(Utf8, BytesThatAreNoneAreReplacedAndAllElseStays) {
  EXPECT_EQ(as_utf8("BM 15285, \xE5\xBA\xAB, \xF0\x92\x80\x80"), "BM 15285, \xE5\xBA\xAB, \xF0\x92\x80\x80");
  EXPECT_EQ(as_utf8("s\xFFss"), "s\xEF\xBF\xBDss");
  EXPECT_EQ(as_utf8("\xC3"), "\xEF\xBF\xBD") << "cut off";
  EXPECT_EQ(as_utf8("\xED\xA0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD") << "a surrogate";
  EXPECT_EQ(as_utf8(""), "");
}

TEST(Utf8, WhatIsNoneIsKnown) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("J\xC3\xB6rg \xEF\xBF\xBD"));
  EXPECT_FALSE(is_utf8("J\xF6rg"));
}

TEST(Utf8, BlanksAroundATextAreNoPartOfIt) {
  EXPECT_EQ(trimmed(" \tBM 1\r\n"), "BM 1");
  EXPECT_EQ(trimmed(" \n"), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Utf8, ControlCharactersAreNoPartOfALine) {
  for (const char* text : {"two\nlines", "a\tb", "\x1B[2J", "\x7F",
                           "\xC2\x9B"
                           "2J"}) {
    EXPECT_FALSE(is_one_line(text)) << text;
    EXPECT_TRUE(is_one_line(one_line(text))) << text;
  }
  EXPECT_EQ(one_line("a\nb\xC2\x9B"
                     "c"),
            "a b c");
  EXPECT_TRUE(
      is_one_line("K\xC3\xBC"
                  "chler, \xE2\x80\x93"));
}

}  // namespace
}  // namespace dubsar
