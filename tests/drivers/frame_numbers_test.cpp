// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/v4l2/frame_numbers.h"

#include <gtest/gtest.h>

namespace dubsar::v4l2 {
namespace {

TEST(FrameNumbers, AFrameThatWentWrongIsLostOnce) {
  FrameNumbers numbers;
  EXPECT_EQ(numbers.take(7).id, 1U);  // it counts from where it likes
  numbers.went_wrong();
  const FrameNumbers::Step behind = numbers.take(9);  // 8 went wrong, and is a gap in the numbers
  EXPECT_EQ(behind.lost, 1U);
  EXPECT_EQ(behind.id, 3U);
  EXPECT_EQ(numbers.take(10).lost, 0U);
  numbers.went_wrong();
  EXPECT_EQ(numbers.take(14).lost, 3U);  // 11 went wrong, of 12 and 13 nobody heard
  for (int k = 0; k < 100; ++k) {
    numbers.went_wrong();  // asked again and again while one is missing
  }
  EXPECT_EQ(numbers.take(16).lost, 1U);
}

TEST(FrameNumbers, OneThatWentWrongCountsOfACameraThatNumbersNone) {
  FrameNumbers numbers;
  EXPECT_EQ(numbers.take(0).lost, 0U);
  numbers.went_wrong();
  numbers.went_wrong();
  EXPECT_EQ(numbers.take(0).lost, 2U);
  EXPECT_EQ(numbers.take(0).lost, 0U);
  FrameNumbers begun;
  begun.went_wrong();
  EXPECT_EQ(begun.take(1).lost, 1U);  // the first of all
}

TEST(FrameNumbers, GoRoundAndStepBack) {
  FrameNumbers numbers;
  EXPECT_EQ(numbers.take(0xfffffffeU).lost, 0U);
  EXPECT_EQ(numbers.take(1).lost, 2U);
  const FrameNumbers::Step back = numbers.take(0);
  EXPECT_EQ(back.lost, 0U);
  EXPECT_EQ(back.id, 5U);
}

}  // namespace
}  // namespace dubsar::v4l2
