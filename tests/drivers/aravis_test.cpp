// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The aravis: driver over real GigE Vision packets: Aravis's fake camera serves our own description of a
// range camera, in another process, on the loopback of a network of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "drivers/loader.h"
#include "tests/drivers/aravis_fixture.h"
#include "tests/support/own_network.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
constexpr const char* kId = "Dubsar-Range 1-SN7";

TEST_F(Aravis, FindsTheCameraAndStreamsItsFrames) {
  const auto found = (*registry_.find("aravis"))->discover().value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].uri, std::string("aravis:") + kId);
  Device device = open({{"format", "Mono8"}}).value();
  const DeviceCapabilities can = device.capabilities().value();
  EXPECT_TRUE(can.yields_frames);
  EXPECT_FALSE(can.yields_scans);
  EXPECT_EQ(can.serial, "SN7");
  EXPECT_EQ(can.model, "Dubsar Range 1");
  ASSERT_TRUE(device.set("width_px", std::int64_t{256}));
  ASSERT_TRUE(device.set("height_px", std::int64_t{64}));
  ASSERT_TRUE(device.set("frame_rate_hz", 100.0));
  ASSERT_TRUE(device.start_frames());
  EXPECT_FALSE(device.set("width_px", std::int64_t{128}));  // not while it streams
  std::int64_t before = 0;
  for (std::int64_t k = 1; k <= 40; ++k) {
    const Frame frame = next(device);
    ASSERT_EQ(frame.width, 256U);
    ASSERT_EQ(frame.height, 64U);
    EXPECT_FALSE(frame.incomplete);
    // A machine that is busy may lose some, and says so.
    EXPECT_EQ(frame.id, k + static_cast<std::int64_t>(device.frame_counters()->lost));
    EXPECT_GT(frame.timestamp_ns, before);
    before = frame.timestamp_ns;
    EXPECT_EQ(frame.pixels[60 * frame.stride_bytes + 200], static_cast<std::uint8_t>(7 * 200 + 3 * 60));
  }
  const std::int64_t now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                               std::chrono::steady_clock::now().time_since_epoch())
                               .count();
  EXPECT_LE(before, now);
  Frame held = next(device);
  ASSERT_TRUE(device.stop_frames());
  EXPECT_EQ(held.pixels[60 * held.stride_bytes + 200], static_cast<std::uint8_t>(7 * 200 + 3 * 60));
  ASSERT_TRUE(device.start_frames(4));
  EXPECT_EQ(next(device).id, 1);
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

// Memory that only comes when it is written to comes too slowly for a fast camera's first frames.
TEST_F(Aravis, ThePoolIsInMemoryBeforeTheFirstFrameComes) {
  Device device = open({{"format", "Mono8"}}).value();
  ASSERT_TRUE(device.set("width_px", std::int64_t{1024}));
  ASSERT_TRUE(device.set("height_px", std::int64_t{1024}));
  ASSERT_TRUE(device.set("frame_rate_hz", 1.0));
  const double before = resident_bytes();
  ASSERT_TRUE(device.start_frames(64));
  EXPECT_GT(resident_bytes() - before, 0.95 * 64 * 1024 * 1024);
}

TEST_F(Aravis, AFrameThatWaitedIsLate) {
  Device device = open({{"format", "Mono8"}}).value();
  ASSERT_TRUE(device.set("frame_rate_hz", 100.0));
  ASSERT_TRUE(device.start_frames(2));
  for (int k = 0; k < 10; ++k) {  // the rate is that of the frames before
    next(device);
  }
  const FrameCounters before = device.frame_counters().value();
  while (device.frame_counters()->starved < before.starved + 20) {
  }
  EXPECT_TRUE(next(device).late);
  EXPECT_GT(device.frame_counters()->late, before.late);
}

TEST_F(Aravis, FeaturesAreTypedSettings) {
  Device device = open({{"format", "Mono16"}}).value();
  const auto settings = device.settings().value();
  const auto exposure = std::ranges::find(settings, "exposure_us", &SettingInfo::key);
  ASSERT_NE(exposure, settings.end());
  EXPECT_EQ(exposure->range, std::pair(10.0, 1e6));
  ASSERT_TRUE(device.set("exposure_us", 2500.0));
  EXPECT_EQ(std::get<double>(device.get("exposure_us").value()), 2500.0);
  EXPECT_EQ(peer_->tell("read 120"), "2500");
  EXPECT_FALSE(device.set("exposure_us", 5.0));
  ASSERT_TRUE(device.set("light", std::int64_t{77}));
  EXPECT_EQ(peer_->tell("read 2400"), "77");
  EXPECT_EQ(peer_->tell("write 2300 4242"), "ok");
  EXPECT_EQ(std::get<std::int64_t>(device.get("encoder").value()), 4242);
  EXPECT_EQ(std::get<std::string>(device.get("pixel_format").value()), "Mono16");
  EXPECT_EQ(std::get<std::string>(device.get("trigger").value()), "free");
  ASSERT_TRUE(device.set("trigger", std::string("software")));
  EXPECT_EQ(std::get<std::string>(device.get("trigger").value()), "software");
  ASSERT_TRUE(device.start_frames());
  const auto none = device.next_frame(100ms);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  ASSERT_TRUE(device.trigger_frame());
  const Frame frame = next(device);
  EXPECT_EQ(frame.format, PixelFormat::kMono16);
  EXPECT_EQ(frame.pixels[2] | frame.pixels[3] << 8, 300);
}

/// Aravis ends the trigger when it sets a rate; a camera that then runs free takes no notice of the line.
TEST_F(Aravis, ARateThatIsSetLeavesTheTriggerAsItIs) {
  Device device = open({{"format", "Mono8"}}).value();
  ASSERT_TRUE(device.set("trigger", std::string("software")));
  ASSERT_TRUE(device.set("frame_rate_hz", 50.0));
  EXPECT_EQ(std::get<std::string>(device.get("trigger").value()), "software");
  EXPECT_NEAR(std::get<double>(device.get("frame_rate_hz").value()), 50.0, 0.01);
  ASSERT_TRUE(device.set("trigger", std::string("line0")));
  ASSERT_TRUE(device.set("frame_rate_hz", 100.0));
  EXPECT_EQ(std::get<std::string>(device.get("trigger").value()), "line0");
  ASSERT_TRUE(device.set("trigger", std::string("free")));
  ASSERT_TRUE(device.set("frame_rate_hz", 50.0));
  EXPECT_EQ(std::get<std::string>(device.get("trigger").value()), "free");
}

// Cameras come from their maker with both on: what is set by hand would be undone with the next frame.
TEST_F(Aravis, AValueSetByHandEndsTheCamerasAutomatic) {
  ASSERT_EQ(peer_->tell("write 2404 2"), "ok");
  ASSERT_EQ(peer_->tell("write 2408 2"), "ok");
  Device device = open({{"format", "Mono8"}}).value();
  ASSERT_TRUE(device.set("exposure_us", 800.0));
  EXPECT_EQ(peer_->tell("read 2404"), "0");
  EXPECT_EQ(peer_->tell("read 2408"), "2") << "nobody has said anything of the gain";
  EXPECT_EQ(std::get<double>(device.get("exposure_us").value()), 800.0);
  EXPECT_FALSE(device.set("gain_raw", std::int64_t{49}));
  ASSERT_TRUE(device.set("gain_raw", std::int64_t{12}));
  EXPECT_EQ(peer_->tell("read 2408"), "0");
  EXPECT_EQ(peer_->tell("read 240c"), "12");
}

TEST_F(Aravis, ARangeCameraYieldsProfiles) {
  constexpr std::int64_t kYear2025Ns = 1'735'689'600'000'000'000;
  Device device = open({{"rows", "200"}, {"row", "0.1"}}).value();
  const DeviceCapabilities can = device.capabilities().value();
  EXPECT_TRUE(can.yields_scans);
  EXPECT_FALSE(can.yields_frames);
  for (int scan = 0; scan < 2; ++scan) {
    Rows rows;
    const auto outcome = device.scan(rows);
    ASSERT_TRUE(outcome) << outcome.error().line();
    ASSERT_EQ(rows.rows.size(), 200U);
    EXPECT_EQ(rows.rows.back(), 199);
    EXPECT_EQ(rows.info.cols, 320);
    EXPECT_EQ(rows.info.expected_rows, 200);
    EXPECT_DOUBLE_EQ(rows.info.spacing_mm, 0.05);
    EXPECT_EQ(rows.info.device, "Dubsar Range 1 SN7");
    EXPECT_GT(rows.info.timestamp_ns, kYear2025Ns);
    EXPECT_FLOAT_EQ(rows.x[100], 100 * 0.05F - 8);
    EXPECT_FLOAT_EQ(rows.y[100], 19.9F);
    EXPECT_FLOAT_EQ(rows.z[100], (1000 + 300 + 39) * 0.01F - 5);
    EXPECT_EQ(rows.valid[5], 0);
    EXPECT_EQ(std::ranges::count(rows.valid, 1), 319);
    EXPECT_TRUE(std::ranges::is_sorted(rows.times));
    ASSERT_TRUE(rows.tally);
    EXPECT_EQ(rows.tally->profiles_sent, 200U);
    EXPECT_EQ(rows.tally->profiles_dropped, 0U);
  }
}

/// Rows that an encoder is to place lay evenly apart instead, wherever the stage was.
TEST_F(Aravis, ACountThatTheCameraDoesNotSendIsNotMadeUp) {
  Device device = open({{"rows", "200"}, {"row", "0.1"}, {"count", "0.001"}}).value();
  Rows rows;
  const auto outcome = device.scan(rows);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
  EXPECT_NE(outcome.error().line().find("sends no count of its encoder"), std::string::npos)
      << outcome.error().line();
  EXPECT_TRUE(rows.rows.empty());
  EXPECT_TRUE(rows.tally);
}

TEST_F(Aravis, FormatsWithMoreAxesBringTheirOwnX) {
  ASSERT_EQ(peer_->tell("write 2104 2"), "ok");
  {
    Device device = open({{"format", "Coord3D_AC16"}, {"rows", "40"}}).value();
    Rows rows;
    ASSERT_TRUE(device.scan(rows));
    EXPECT_FLOAT_EQ(rows.x[100], 200 * 0.05F - 8);
    EXPECT_FLOAT_EQ(rows.y[100], 39 * 0.1F);  // of the camera's scale of B
    EXPECT_EQ(rows.valid[5], 0);
  }
  {
    Device device = open({{"format", "Coord3D_ABC32f"}, {"rows", "40"}, {"flip", "1"}}).value();
    Rows rows;
    ASSERT_TRUE(device.scan(rows));
    EXPECT_FLOAT_EQ(rows.x[100], 50 * 0.05F - 8);
    EXPECT_FLOAT_EQ(rows.y[100], 3.9F);
    EXPECT_FLOAT_EQ(rows.z[100], -(25 * 0.01F - 5));
    EXPECT_EQ(rows.valid[5], 0);
  }
}

TEST_F(Aravis, LostPacketsLeaveGapsNotInventions) {
  Device device = open({{"rows", "2000"}, {"packet", "1500"}}).value();
  ASSERT_EQ(peer_->tell("lose 0.03"), "ok");  // this peer has no resend: what is lost stays lost
  Rows rows;
  const auto outcome = device.scan(rows);
  ASSERT_TRUE(outcome) << outcome.error().line();
  ASSERT_TRUE(rows.tally);
  EXPECT_GT(rows.tally->profiles_dropped, 0U);
  EXPECT_EQ(rows.tally->profiles_sent, rows.rows.size());
  EXPECT_LT(rows.rows.size(), 2000U);
  EXPECT_TRUE(std::ranges::adjacent_find(rows.rows, std::greater_equal<>()) == rows.rows.end());
}

TEST_F(Aravis, ASinkOrAnotherThreadEndsAScan) {
  Device device = open({{"rows", "100000"}}).value();
  Rows rows;
  rows.most = 50;
  EXPECT_EQ(device.scan(rows).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(rows.rows.size(), 50U);
  EXPECT_TRUE(rows.tally);
  Rows more;
  std::jthread stopper;
  more.each = [&] {
    if (more.rows.size() == 100) {
      stopper = std::jthread([&] { EXPECT_TRUE(device.stop()); });
    }
  };
  EXPECT_EQ(device.scan(more).error().kind, ErrorKind::kCancelled);
  EXPECT_GE(more.rows.size(), 100U);
  Rows last;
  last.most = 10;
  EXPECT_EQ(device.scan(last).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(last.rows.size(), 10U);
}

TEST_F(Aravis, UnpluggedInMidScanKeepsWhatCameAndGoesOnLater) {
  Device device = open({{"rows", "1000000"}}).value();
  ASSERT_TRUE(device.set("light", std::int64_t{55}));
  std::mt19937 random(3);
  for (int round = 0; round < 3; ++round) {
    const std::size_t when = 1 + random() % 400;
    Rows rows;
    rows.each = [&] {
      if (rows.rows.size() == when) {
        unplug();
      }
    };
    const auto outcome = device.scan(rows);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().kind, ErrorKind::kDevice);
    EXPECT_THAT(outcome.error().line(), HasSubstr("plug it in again"));
    EXPECT_GE(rows.rows.size(), when);
    ASSERT_TRUE(rows.tally);
    EXPECT_EQ(rows.tally->profiles_sent, rows.rows.size());
    ASSERT_NO_FATAL_FAILURE(plug_in({}));
    Rows again;
    again.most = 100;
    EXPECT_EQ(device.scan(again).error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(again.rows.size(), 100U);
    EXPECT_EQ(peer_->tell("read 2400"), "55");  // its settings are as they were
  }
}

TEST_F(Aravis, AFrozenCameraIsNoticedAndAnotherIsNotTakenForIt) {
  Device device = open({{"format", "Mono8"}}).value();
  ASSERT_TRUE(device.start_frames());
  Frame held = next(device);
  ASSERT_EQ(::kill(peer_->pid(), SIGSTOP), 0);
  Status gone;
  while (gone) {
    const auto frame = device.next_frame(60s);
    ASSERT_TRUE(!frame || *frame) << "neither a frame nor an error";
    gone = frame ? Status{} : std::unexpected(frame.error());
  }
  EXPECT_EQ(gone.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(held.pixels[1000], static_cast<std::uint8_t>(7 * (1000 % 320) + 3 * (1000 / 320)));
  unplug();
  const Status missing = device.start_frames();
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kDevice);
  ASSERT_NO_FATAL_FAILURE(plug_in({"MODEL=Other 2"}));
  const Status other = device.start_frames();
  ASSERT_FALSE(other);
  // Aravis may still know the address, or look for the name anew.
  EXPECT_THAT(other.error().line(), testing::AnyOf(HasSubstr("another camera is there now: Dubsar Other 2"),
                                                   HasSubstr("the camera is not there")));
}

TEST_F(Aravis, ARefusalSaysWhatToDo) {
  const Driver& driver = **registry_.find("aravis");
  EXPECT_EQ(driver.open("", {}).error().kind, ErrorKind::kUsage);
  EXPECT_THAT(driver.open("Nobody-1", {}).error().line(), HasSubstr("the camera is not there"));
  EXPECT_THAT(open({{"format", "Mono12Packed"}}).error().line(), HasSubstr("it offers Mono8"));
  EXPECT_THAT(open({{"format", "Mono10"}}).error().line(),
              HasSubstr("does not offer the format Mono10; it offers Mono8"));
  ASSERT_EQ(peer_->tell("write 2104 3"), "ok");
  {
    Device device = open().value();
    Rows rows;
    const auto outcome = device.scan(rows);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().line(), HasSubstr("UncalibratedC does not say where a sample is"));
    EXPECT_FALSE(rows.tally);
    ASSERT_EQ(peer_->tell("write 2104 0"), "ok");
    ASSERT_EQ(peer_->tell("double 2210 nan"), "ok");
    EXPECT_EQ(device.scan(rows).error().kind, ErrorKind::kBadInput);
    EXPECT_FALSE(device.start_frames());
  }
  ASSERT_EQ(peer_->tell("write 300 1"), "ok");
  ASSERT_EQ(peer_->tell("double 2210 0.01"), "ok");
  ASSERT_EQ(peer_->tell("write 304 1"), "ok");
  Device waiting = open({{"wait", "0.2"}}).value();
  Rows rows;
  const auto silent = waiting.scan(rows);
  ASSERT_FALSE(silent);
  EXPECT_THAT(silent.error().line(), HasSubstr("sends no profiles"));
  EXPECT_TRUE(rows.tally);
}

TEST_F(Aravis, ADescriptionThatLiesOrBreaksOffIsBadInput) {
  unplug();
  ASSERT_NO_FATAL_FAILURE(plug_in({"lies"}));
  {
    Device device = open().value();
    Rows rows;
    const auto outcome = device.scan(rows);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(outcome.error().line(), HasSubstr("bytes for frames of 320 x 40"));
  }
  unplug();
  ASSERT_NO_FATAL_FAILURE(plug_in({"truncated"}));
  const auto opened = open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(opened.error().line(), HasSubstr("description (GenICam)"));
  EXPECT_THAT(opened.error().line(), HasSubstr("update its firmware"));
}

}  // namespace
}  // namespace dubsar

int main(int count, char** words) {
  dubsar::own_network = dubsar::test::enter_own_network();
  testing::InitGoogleTest(&count, words);
  return RUN_ALL_TESTS();
}
