// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/time_left.h"

#include <gtest/gtest.h>

namespace dubsar::ui {
namespace {

TEST(TimeLeft, IsToldByThePartThatIsDone) {
  TimeLeft left;
  EXPECT_FALSE(left.of("wedges", 0.0, 100));
  EXPECT_FALSE(left.of("wedges", 0.5, 101)) << "too early";
  ASSERT_TRUE(left.of("wedges", 0.5, 110));
  EXPECT_DOUBLE_EQ(*left.of("wedges", 0.5, 110), 10);
  EXPECT_DOUBLE_EQ(*left.of("wedges", 0.8, 140), 10);
  EXPECT_DOUBLE_EQ(*left.of("wedges", 1.0, 150), 0);
}

TEST(TimeLeft, AnotherStageAndOneThatBeginsAgainAreNotMixed) {
  TimeLeft left;
  EXPECT_FALSE(left.of("reading", 0.9, 0));
  EXPECT_FALSE(left.of("writing", 0.1, 100));
  EXPECT_DOUBLE_EQ(*left.of("writing", 0.5, 110), 10);
  EXPECT_FALSE(left.of("writing", 0.1, 120)) << "it has gone back";
}

}  // namespace
}  // namespace dubsar::ui
