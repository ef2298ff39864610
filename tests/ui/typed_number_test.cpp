// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/typed_number.h"

#include <gtest/gtest.h>

namespace dubsar::ui {
namespace {

TEST(TypedNumber, TakesAPointOrAComma) {
  EXPECT_EQ(typed_number("1.5"), 1.5);
  EXPECT_EQ(typed_number("1,5"), 1.5);
  EXPECT_EQ(typed_number(" -20,25 "), -20.25);
}

TEST(TypedNumber, DriversReadAPoint) {
  EXPECT_EQ(number_word(" 0,25 "), "0.25");
  EXPECT_EQ(number_word("1e3"), "1e3");
  EXPECT_EQ(number_word("1,2,3"), "1,2,3");
}

TEST(TypedNumber, WhatIsNoNumberIsNone) {
  for (const char* text : {"", " ", "mm", "1,2,3", "1.000,5", "1.5 mm", "inf", "nan"}) {
    EXPECT_EQ(typed_number(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace dubsar::ui
