// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the v4l2: driver has a camera send: pixel format, size, rate, region.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>

#include "drivers/v4l2/camera.h"
#include "tests/drivers/v4l2_fixture.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class V4l2Mode : public test::V4l2Camera {};

v4l2::Mode mode(const char* name, std::uint32_t width, std::uint32_t height, double rate) {
  return {*v4l2::fourcc_from(name), width, height, rate};
}

TEST(V4l2Modes, PreferUncompressedMonoThenPixelsThenRate) {
  const std::vector<v4l2::Mode> all{mode("MJPG", 1920, 1080, 60), mode("YUYV", 1920, 1080, 5),
                                    mode("NV12", 1280, 720, 30),  mode("Y16", 640, 480, 60),
                                    mode("GREY", 640, 480, 60),   mode("GREY", 640, 480, 90),
                                    mode("GREY", 320, 240, 200)};
  EXPECT_EQ(v4l2::choose(all, {}, "").value(), mode("GREY", 640, 480, 90));
  EXPECT_EQ(v4l2::choose(std::span(all).first(5), {}, "").value(), mode("GREY", 640, 480, 60));
  EXPECT_EQ(v4l2::choose(std::span(all).first(3), {}, "").value(), mode("NV12", 1280, 720, 30));
  const std::vector<v4l2::Mode> colours{mode("MJPG", 1920, 1080, 60), mode("BGR3", 640, 480, 10)};
  EXPECT_EQ(v4l2::choose(colours, {}, "").value(), colours[1]);
  EXPECT_EQ(v4l2::choose(std::span(all).first(2), {}, "").value(), mode("YUYV", 1920, 1080, 5));
  EXPECT_EQ(v4l2::choose(all, {.rate_hz = 120}, "").value(), mode("GREY", 320, 240, 120));
  EXPECT_EQ(v4l2::choose(all, {.size = std::pair(1920U, 1080U)}, "").value(), mode("YUYV", 1920, 1080, 5));
  const auto none = v4l2::choose(all, {.rate_hz = 500}, "cam");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(none.error().line(), HasSubstr("MJPG 1920x1080 at 60/s"));
  EXPECT_FALSE(v4l2::choose({}, {}, "cam"));
}

TEST(V4l2Modes, KnowWhoseLumaHasTheRangeOfTelevision) {
  const auto limited = [](const char* name, std::uint32_t quantization) {
    return v4l2::has_limited_range(*v4l2::fourcc_from(name), quantization);
  };
  for (const char* yuv : {"YUYV", "UYVY", "NV12"}) {
    EXPECT_TRUE(limited(yuv, V4L2_QUANTIZATION_LIM_RANGE)) << yuv;
    EXPECT_FALSE(limited(yuv, V4L2_QUANTIZATION_FULL_RANGE)) << yuv;
    EXPECT_FALSE(limited(yuv, V4L2_QUANTIZATION_DEFAULT)) << yuv;  // webcams say nothing, and send all values
  }
  for (const char* converted : {"RGB3", "BA81"}) {  // by libv4l2, whatever the camera says of its own pixels
    EXPECT_TRUE(limited(converted, V4L2_QUANTIZATION_FULL_RANGE)) << converted;
  }
  for (const char* whole : {"GREY", "Y16", "MJPG", "PJPG"}) {
    EXPECT_FALSE(limited(whole, V4L2_QUANTIZATION_LIM_RANGE)) << whole;
  }
}

TEST(V4l2Modes, WhatIsSaturatedOfALimitedRangeReadsSo) {
  std::vector<std::uint8_t> luma{0, 16, 17, 125, 126, 234, 235, 255};
  v4l2::expand_range(luma);
  EXPECT_THAT(luma, testing::ElementsAre(0, 0, 1, 127, 128, 254, 255, 255));
}

TEST(V4l2Modes, KeysAreWordsOfNames) {
  EXPECT_EQ(v4l2::key_from("White Balance, Automatic"), "white_balance_automatic");
  EXPECT_EQ(v4l2::key_from(" (?) "), "");
}

TEST_F(V4l2Mode, ARateIsASettingThatStays) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  EXPECT_EQ(std::get<double>(device.get("frame_rate_hz").value()), 100.0);
  ASSERT_TRUE(device.set("frame_rate_hz", 50.0));
  EXPECT_EQ(std::get<double>(device.get("frame_rate_hz").value()), 50.0);
  const Status between = device.set("frame_rate_hz", 2.5);  // this one counts in whole frames
  ASSERT_FALSE(between);
  EXPECT_THAT(between.error().line(), HasSubstr("does not send 2.5 frames a second; it would send 3"));
  EXPECT_EQ(std::get<double>(device.get("frame_rate_hz").value()), 50.0);
  ASSERT_TRUE(device.start_frames());
  next(device);
  EXPECT_THAT(device.set("frame_rate_hz", 20.0).error().line(), HasSubstr("while frames run"));
  ASSERT_EQ(peer_->tell("unplug"), "ok");
  while (device.next_frame(60s)) {
  }
  ASSERT_EQ(peer_->tell("plug"), "ok");  // at its own rate
  ASSERT_TRUE(device.start_frames());
  EXPECT_EQ(std::get<double>(device.get("frame_rate_hz").value()), 50.0) << "as the camera tells it";
}

TEST_F(V4l2Mode, ARegionIsSentWhereTheCameraHasOne) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:320x240@100"}));
  if (IsSkipped()) {
    return;
  }
  ASSERT_EQ(peer_->tell("crop 4"), "ok");
  const auto at = [](Device& device, const char* key) {
    return std::get<std::int64_t>(device.get(key).value());
  };
  {
    Device device = open().value();
    const auto settings = device.settings().value();
    const auto width = std::ranges::find(settings, "width_px", &SettingInfo::key);
    ASSERT_NE(width, settings.end());
    EXPECT_EQ(width->range, std::pair(1.0, 320.0));
    EXPECT_FALSE(device.set("offset_x_px", std::int64_t{16})) << "all of the picture cannot move";
    ASSERT_TRUE(device.set("width_px", std::int64_t{200}));
    ASSERT_TRUE(device.set("height_px", std::int64_t{60}));
    ASSERT_TRUE(device.set("offset_x_px", std::int64_t{100}));
    ASSERT_TRUE(device.set("offset_y_px", std::int64_t{140}));
    const Status odd = device.set("offset_y_px", std::int64_t{141});
    ASSERT_FALSE(odd);
    EXPECT_THAT(odd.error().line(), HasSubstr("it can send 200 x 60 from 100, 140 on"));
    EXPECT_EQ(at(device, "offset_y_px"), 140);
    const auto expect_region = [&](const Frame& frame) {
      EXPECT_EQ(frame.width, 200U);
      EXPECT_EQ(frame.height, 60U);
      EXPECT_EQ(frame.offset_x, 100U);
      EXPECT_EQ(frame.offset_y, 140U);
      EXPECT_EQ(frame.pixels[31 * frame.stride_bytes + 17], painted(117, 171));
    };
    ASSERT_TRUE(device.start_frames());
    expect_region(next(device));
    EXPECT_THAT(device.set("width_px", std::int64_t{100}).error().line(), HasSubstr("while frames run"));
    ASSERT_EQ(peer_->tell("unplug"), "ok");
    while (device.next_frame(60s)) {
    }
    ASSERT_EQ(peer_->tell("plug"), "ok");  // with its whole picture
    ASSERT_TRUE(device.start_frames());
    expect_region(next(device));
    ASSERT_TRUE(device.stop_frames());
  }
  // A camera keeps its region; whoever opens it next gets the whole picture.
  Device again = open().value();
  EXPECT_EQ(at(again, "width_px"), 320);
  ASSERT_TRUE(again.start_frames());
  EXPECT_EQ(next(again).pixels[31 * 320 + 17], painted(17, 31));
}

}  // namespace
}  // namespace dubsar
