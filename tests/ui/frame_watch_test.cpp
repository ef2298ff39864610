// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/frame_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dubsar::ui {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::SizeIs;

FrameWatch::Clock::time_point at(int ms) {
  return FrameWatch::Clock::time_point(milliseconds(ms));
}

TEST(FrameWatch, AFrameBelongsToTheWorkThatMostOfItWentInto) {
  FrameWatch watch;
  watch.begin(at(0));
  watch.start("upload", at(10));
  watch.finish(at(310));
  watch.start("turn", at(320));
  watch.finish(at(360));
  watch.end(at(380));
  ASSERT_THAT(watch.kinds(), SizeIs(1));
  const FrameWatch::Kind& upload = watch.kinds().at("upload");
  EXPECT_EQ(upload.frames, 1U);
  EXPECT_EQ(upload.slow, 1U);
  EXPECT_DOUBLE_EQ(upload.longest_s, 0.38);
}

TEST(FrameWatch, WorkWithinWorkIsItsOwn) {
  FrameWatch watch;
  watch.begin(at(0));
  watch.start("viewer", at(0));
  watch.start("select", at(10));
  watch.finish(at(70));
  watch.finish(at(100));
  watch.end(at(100));
  EXPECT_EQ(watch.kinds().count("select"), 1U);  // 60 ms, and 40 of the viewer around it
  EXPECT_EQ(watch.kinds().count("viewer"), 0U);
}

TEST(FrameWatch, WhatNothingWasSaidOfIsThePanels) {
  FrameWatch watch;
  watch.begin(at(0));
  watch.start("turn", at(0));
  watch.finish(at(10));
  watch.end(at(30));
  EXPECT_EQ(watch.kinds().count("panels"), 1U);
}

TEST(FrameWatch, AnInputMayHaveWaitedForTheFrameBeforeToo) {
  FrameWatch watch;
  watch.begin(at(0));
  watch.start("turn", at(0));
  watch.finish(at(150));
  watch.end(at(150));
  watch.begin(at(900));  // nothing happened meanwhile
  watch.start("turn", at(900));
  watch.finish(at(1000));
  watch.end(at(1000));
  EXPECT_DOUBLE_EQ(watch.kinds().at("turn").longest_wait_s, 0.25);
  EXPECT_DOUBLE_EQ(watch.kinds().at("turn").longest_s, 0.15);
  EXPECT_EQ(watch.kinds().at("turn").slow, 0U);
}

TEST(FrameWatch, AScreenshotOfAScriptIsNobodysWait) {
  FrameWatch watch;
  watch.begin(at(0));
  watch.leave_out();
  watch.end(at(700));
  EXPECT_TRUE(watch.kinds().empty());
  watch.begin(at(700));
  watch.end(at(720));
  EXPECT_DOUBLE_EQ(watch.kinds().at("panels").longest_wait_s, 0.02);
}

TEST(FrameWatch, TheLongestIsToldFirst) {
  FrameWatch watch;
  int now = 0;
  for (const auto& [work, ms] : {std::pair{"turn", 40}, {"upload", 300}}) {
    watch.begin(at(now), "line 7");
    watch.start(work, at(now));
    now += ms;
    watch.finish(at(now));
    watch.end(at(now));
  }
  ASSERT_THAT(watch.lines(), SizeIs(2));
  EXPECT_THAT(watch.lines()[0], HasSubstr("upload"));
  EXPECT_THAT(watch.lines()[0], HasSubstr("longest frame 300 ms (panels 0, upload 300; line 7)"));
  EXPECT_THAT(watch.lines()[0], HasSubstr("1 of 1 frames above 200 ms"));
}

}  // namespace
}  // namespace dubsar::ui
