// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/camera_clock.h"

#include <gtest/gtest.h>

namespace dubsar::aravis {
namespace {

constexpr std::int64_t kMs = 1000000;

TEST(CameraClock, WithoutAnAnswerTheQuickestFrameTells) {
  CameraClock clock{std::nullopt};
  EXPECT_EQ(clock.ours(1000 * kMs, 5007 * kMs), 5007 * kMs);
  EXPECT_EQ(clock.ours(1010 * kMs, 5013 * kMs), 5013 * kMs) << "4 ms quicker than the first";
  EXPECT_EQ(clock.ours(1020 * kMs, 5040 * kMs), 5023 * kMs) << "a slow one";
}

TEST(CameraClock, AnAnswerIsBetterThanAnyFrame) {
  CameraClock clock{4000 * kMs};
  EXPECT_EQ(clock.ours(1000 * kMs, 5007 * kMs), 5000 * kMs);
  EXPECT_EQ(clock.ours(1010 * kMs, 5033 * kMs), 5010 * kMs);
  EXPECT_EQ(clock.ours(1020 * kMs, 5019 * kMs), 5019 * kMs) << "no frame comes before it was taken";
}

TEST(CameraClock, AnAnswerThatCannotBeIsNotBelieved) {
  CameraClock late{4008 * kMs};
  EXPECT_EQ(late.ours(1000 * kMs, 5007 * kMs), 5007 * kMs);
  CameraClock other{-3600000 * kMs};
  EXPECT_EQ(other.ours(1000 * kMs, 5007 * kMs), 5007 * kMs);
}

}  // namespace
}  // namespace dubsar::aravis
