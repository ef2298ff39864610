// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The v4l2: driver against a camera that the kernel serves through FUSE: open, ioctl, poll and mmap are real.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "drivers/v4l2/camera.h"
#include "tests/drivers/v4l2_fixture.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class V4l2 : public test::V4l2Camera {};

TEST_F(V4l2, StreamsFramesInOrderAndWhole) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"YUYV:640x480@30", "GREY:320x240@200"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  const DeviceCapabilities can = device.capabilities().value();
  EXPECT_TRUE(can.yields_frames);
  EXPECT_FALSE(can.yields_scans);
  EXPECT_EQ(can.model, "Virtual-1");
  EXPECT_EQ(std::get<std::string>(device.get("pixel_format").value()), "GREY");
  ASSERT_TRUE(device.start_frames());
  std::int64_t before_ns = 0;
  for (std::int64_t k = 1; k <= 60; ++k) {
    const Frame frame = next(device);
    ASSERT_EQ(frame.width, 320U);
    ASSERT_EQ(frame.height, 240U);
    EXPECT_EQ(frame.format, PixelFormat::kMono8);
    EXPECT_EQ(painted_number(frame) + 1, frame.id);
    EXPECT_EQ(frame.pixels[100 * frame.stride_bytes + 17], painted(17, 100));
    EXPECT_EQ(frame.pixels[239 * frame.stride_bytes + 319], painted(319, 239));
    EXPECT_GT(frame.timestamp_ns, before_ns);
    EXPECT_FALSE(frame.exposed) << "uvcvideo says so of each, and stamps the arrival";
    before_ns = frame.timestamp_ns;
  }
  EXPECT_TRUE(device.stop_frames());
  const FrameCounters counts = device.frame_counters().value();
  EXPECT_EQ(counts.delivered, 60U);
  EXPECT_EQ(counts.incomplete, 0U);
  EXPECT_FALSE(device.next_frame(1s));
  ASSERT_TRUE(device.start_frames(4));  // and again
  EXPECT_EQ(painted_number(next(device)), 0U);
  EXPECT_EQ(device.frame_counters()->pool, 4U);
}

TEST_F(V4l2, TakesTheLumaOfWhatIsNotMono) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"RGB3:160x120@50", "YUYV:320x240@50", "Y12:320x240@50"}));
  if (IsSkipped()) {
    return;
  }
  {
    Device packed = open({{"format", "YUYV"}}).value();
    ASSERT_TRUE(packed.start_frames());
    const Frame luma = next(packed);
    EXPECT_EQ(luma.format, PixelFormat::kMono8);
    EXPECT_EQ(luma.pixels[50 * luma.stride_bytes + 17], painted(17, 50));
    ASSERT_TRUE(packed.stop_frames());
    EXPECT_EQ(luma.pixels[50 * luma.stride_bytes + 17], painted(17, 50));
  }
  {
    Device two_bytes = open({{"format", "Y12"}}).value();
    ASSERT_TRUE(two_bytes.start_frames());
    const Frame deep = next(two_bytes);
    EXPECT_EQ(deep.format, PixelFormat::kMono12);
    EXPECT_EQ(deep.stride_bytes, 640U);
  }

  // Through libv4l2, whose luma has the range of television, 16 to 235: it is expanded.
  Device colour = open({{"format", "RGB3"}}).value();
  ASSERT_TRUE(colour.start_frames());
  const Frame grey = next(colour);
  ASSERT_EQ(grey.width, 160U);
  for (const auto& [x, y] : {std::pair(17U, 50U), std::pair(100U, 119U)}) {
    EXPECT_NEAR(grey.pixels[y * grey.stride_bytes + x], painted(x, y), 6);
  }
}

TEST_F(V4l2, UnpacksMotionJpegAndDropsWhatIsNone) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"MJPG:320x240@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open({{"buffers", "4"}}).value();
  ASSERT_TRUE(device.start_frames());
  const Frame luma = next(device);
  ASSERT_EQ(luma.format, PixelFormat::kMono8);
  ASSERT_EQ(luma.width, 320U);
  for (const auto& [x, y] : {std::pair(10U, 20U), std::pair(100U, 119U), std::pair(310U, 230U)}) {
    EXPECT_NEAR(luma.pixels[y * luma.stride_bytes + x], painted(x, y), 4);
  }
  // Bytes that are no picture, or half of one, are frames that were lost; the next one is whole.
  std::int64_t before = luma.id;
  for (const auto& [trouble, count] : {std::pair("spoil 2", 2U), std::pair("shorten 1", 1U)}) {
    const std::uint64_t lost = device.frame_counters()->lost;
    ASSERT_EQ(peer_->tell(trouble), "ok");
    while (device.frame_counters()->lost < lost + count) {
      const Frame frame = next(device);
      ASSERT_FALSE(frame.incomplete);
      ASSERT_GT(frame.id, before);
      ASSERT_NEAR(frame.pixels[119 * frame.stride_bytes + 100], painted(100, 119), 4);
      before = frame.id;
    }
  }
}

TEST_F(V4l2, CountsWhatIsLostSpoiltOrHeldTooLong) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@200"}));
  if (IsSkipped()) {
    return;
  }
  Device device = streaming();
  ASSERT_EQ(peer_->tell("lose 3"), "ok");
  ASSERT_EQ(peer_->tell("spoil 1"), "ok");
  bool incomplete = false;
  std::uint64_t lost = 0;
  while (!incomplete || lost < 3) {
    incomplete = next(device).incomplete || incomplete;
    lost = device.frame_counters()->lost;
  }
  ASSERT_EQ(peer_->tell("shorten 1"), "ok");
  while (!next(device).incomplete) {
  }
  EXPECT_EQ(device.frame_counters()->incomplete, 2U);

  // All of the pool held: nothing comes, and nothing hangs. A busy machine may take a while to send anything.
  Frame after;
  for (int tries = 0; tries < 100 && device.frame_counters()->lost == lost; ++tries) {
    std::vector<Frame> held;
    for (int k = 0; k < 4; ++k) {
      held.push_back(next(device));
    }
    const auto none = device.next_frame(30ms);
    ASSERT_TRUE(none);
    EXPECT_FALSE(*none);
    const std::uint8_t kept = held[0].pixels[1000];
    EXPECT_EQ(kept, painted(1000 % 160, 1000 / 160));
    held.clear();
    after = next(device);
  }
  EXPECT_GT(device.frame_counters()->lost, lost);
  EXPECT_EQ(painted_number(after) + 1, after.id);
}

TEST_F(V4l2, AFrameThatWaitedIsLate) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@200"}));
  if (IsSkipped()) {
    return;
  }
  Device device = streaming();
  const std::uint64_t before = device.frame_counters()->late;
  const auto made = [&] { return std::stoll(peer_->tell("counts")); };
  for (const long long then = made(); made() < then + 40;) {
  }
  EXPECT_TRUE(next(device).late);
  EXPECT_GT(device.frame_counters()->late, before);
}

TEST_F(V4l2, ControlsAreTypedSettings) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  const auto settings = device.settings().value();
  const auto exposure = std::ranges::find(settings, "exposure_us", &SettingInfo::key);
  ASSERT_NE(exposure, settings.end());
  EXPECT_EQ(exposure->unit, "us");
  EXPECT_EQ(exposure->range, std::pair(100.0, 500000.0));
  EXPECT_EQ(std::get<std::string>(device.get("auto_exposure").value()), "Aperture Priority Mode");
  ASSERT_TRUE(device.set("exposure_us", 2500.0));  // which ends the automatic
  EXPECT_EQ(std::get<double>(device.get("exposure_us").value()), 2500.0);
  EXPECT_EQ(std::get<std::string>(device.get("auto_exposure").value()), "Manual Mode");
  EXPECT_FALSE(device.set("exposure_us", 1e9));
  EXPECT_FALSE(device.set("gain", std::int64_t{101}));
  EXPECT_TRUE(std::get<bool>(device.get("gain_automatic").value()));
  ASSERT_TRUE(device.set("gain", std::int64_t{40}));  // which ends that
  EXPECT_EQ(std::get<std::int64_t>(device.get("gain").value()), 40);
  EXPECT_FALSE(std::get<bool>(device.get("gain_automatic").value()));
  EXPECT_FALSE(device.set("width_px", std::int64_t{100})) << "this one sends its whole picture";
}

TEST_F(V4l2, ARefusalSaysWhatToDo) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  ASSERT_EQ(peer_->tell("deny"), "ok");
  EXPECT_THAT(open().error().line(),
              HasSubstr("no right to use the camera; join the group video, or copy 60-dubsar.rules"));
  EXPECT_EQ(open().error().kind, ErrorKind::kDevice);
  EXPECT_THAT(v4l2::find_cameras(folder_.path()),
              testing::ElementsAre(testing::Pair(node(), HasSubstr("no right to use the camera; join"))));
  ASSERT_EQ(peer_->tell("occupy"), "ok");
  EXPECT_THAT(open().error().line(), HasSubstr("in use by another program"));
  ASSERT_EQ(peer_->tell("allow"), "ok");
  Device mine = open().value();
  ASSERT_TRUE(mine.start_frames());
  EXPECT_THAT(open().error().line(), HasSubstr("in use by another program"));
  ASSERT_TRUE(peer_->tell("unplug") == "ok");
  EXPECT_THAT(open().error().line(), HasSubstr("the camera is not there"));
  ASSERT_TRUE(peer_->tell("plug") == "ok");
  for (const auto& [key, value] : Options{{"format", "JUNK!"},
                                          {"size", "10"},
                                          {"size", "ax3"},
                                          {"rate", "-1"},
                                          {"buffers", "1"},
                                          {"format", "Y16"},
                                          {"size", "64x64"}}) {
    const auto refused = open({{key, value}});
    ASSERT_FALSE(refused) << key << "=" << value;
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage) << refused.error().line();
  }
  std::ofstream(folder_.path().string() + ".txt") << "no camera";
  const auto file = (*registry_.find("v4l2"))->open(folder_.path().string() + ".txt", {});
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().line(), HasSubstr("not a camera"));
  std::filesystem::remove(folder_.path().string() + ".txt");
}

/// What it says of its lines reaches beyond its buffers: read so, the program would end.
TEST_F(V4l2, LinesLongerThanThereIsRoomForAreRefused) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"Y12:320x240@100", "YUYV:320x240@100"}));
  if (IsSkipped()) {
    return;
  }
  ASSERT_EQ(peer_->tell("stretch"), "ok");
  for (const char* format : {"Y12", "YUYV"}) {
    Device device = open({{"format", format}}).value();
    const Status started = device.start_frames();
    ASSERT_FALSE(started) << format;
    EXPECT_THAT(started.error().line(), HasSubstr("smaller than its frames; ask for another"));
  }
}

TEST_F(V4l2, UnpluggedInMidStreamAndPluggedInAgain) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:320x240@200"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  ASSERT_TRUE(device.set("gain", std::int64_t{77}));
  std::mt19937 random(7);
  for (std::uint64_t round = 1; round <= 3; ++round) {
    ASSERT_TRUE(device.start_frames());
    Frame held = next(device);
    for (auto frames = random() % 30; frames > 0; --frames) {
      held = next(device);
    }
    const std::uint32_t number = painted_number(held);
    ASSERT_EQ(peer_->tell("unplug"), "ok");
    Status gone;
    while (gone) {  // those that were on their way may still come
      const auto frame = device.next_frame(60s);
      ASSERT_TRUE(!frame || *frame) << "no frame and no error";
      gone = frame ? Status{} : std::unexpected(frame.error());
    }
    EXPECT_EQ(gone.error().kind, ErrorKind::kDevice);
    EXPECT_THAT(gone.error().line(), HasSubstr("plug it in again"));
    EXPECT_EQ(painted_number(held), number);
    EXPECT_EQ(held.pixels.back(), painted(319, 239));
    EXPECT_FALSE(device.start_frames());
    ASSERT_EQ(peer_->tell("plug"), "ok");
    ASSERT_TRUE(device.start_frames());
    EXPECT_EQ(next(device).width, 320U);
    EXPECT_EQ(std::get<std::int64_t>(device.get("gain").value()), 77);
    EXPECT_EQ(device.frame_counters()->reconnections, round);
    ASSERT_TRUE(device.stop_frames());
  }
  ASSERT_EQ(peer_->tell("rename Another"), "ok");
  const Status other = device.start_frames();
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().line(), HasSubstr("another camera is there now: Another"));
}

/// A lens that focuses by itself has another focal length in each scan.
TEST_F(V4l2, AutofocusEndsWhenTheCameraIsOpenedAndWhenItIsPluggedInAgain) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  const auto automatic = [&] { return std::get<bool>(device.get("focus_automatic_continuous").value()); };
  EXPECT_FALSE(automatic());
  ASSERT_TRUE(device.start_frames());
  ASSERT_EQ(peer_->tell("unplug"), "ok");
  while (device.next_frame(60s)) {
  }
  ASSERT_EQ(peer_->tell("plug"), "ok");
  ASSERT_TRUE(device.start_frames());
  EXPECT_FALSE(automatic());
}

/// In the order of their numbers the focus would stand before what lets it be set.
TEST_F(V4l2, PluggedInAgainItsAutomaticsAreAsTheyWereSetLast) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  const auto plug_in_again = [&] {
    ASSERT_TRUE(device.start_frames());
    ASSERT_EQ(peer_->tell("unplug"), "ok");
    while (device.next_frame(60s)) {
    }
    ASSERT_EQ(peer_->tell("plug"), "ok");
    for (int start = 0; start < 2; ++start) {
      const Status started = device.start_frames();
      ASSERT_TRUE(started) << started.error().line();
      ASSERT_TRUE(device.stop_frames());
    }
  };
  const auto focus = [&] { return std::get<std::int64_t>(device.get("focus_absolute").value()); };
  const auto automatic = [&] { return std::get<bool>(device.get("focus_automatic_continuous").value()); };
  ASSERT_TRUE(device.set("focus_automatic_continuous", true));
  const Status early = device.set("focus_absolute", std::int64_t{120});
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(early.error().line(), HasSubstr("another setting puts this one out of use: focus_absolute; end "
                                              "the camera's automatic of it first"));
  ASSERT_TRUE(device.set("focus_automatic_continuous", false));
  ASSERT_TRUE(device.set("focus_absolute", std::int64_t{120}));
  ASSERT_TRUE(device.set("exposure_us", 2500.0));
  ASSERT_NO_FATAL_FAILURE(plug_in_again());
  EXPECT_EQ(focus(), 120);
  EXPECT_FALSE(automatic());
  EXPECT_EQ(std::get<std::string>(device.get("auto_exposure").value()), "Manual Mode");
  EXPECT_EQ(std::get<double>(device.get("exposure_us").value()), 2500.0);

  ASSERT_TRUE(device.set("focus_automatic_continuous", true));
  ASSERT_TRUE(device.set("auto_exposure", std::string("Aperture Priority Mode")));
  ASSERT_NO_FATAL_FAILURE(plug_in_again());
  EXPECT_TRUE(automatic());
  EXPECT_EQ(std::get<std::string>(device.get("auto_exposure").value()), "Aperture Priority Mode");
}

TEST_F(V4l2, AStreamThatStandsStillTimesOut) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  Device device = open().value();
  ASSERT_TRUE(device.start_frames());
  ASSERT_EQ(peer_->tell("pause"), "ok");
  while (device.next_frame(100ms).value()) {
  }
  ASSERT_EQ(peer_->tell("resume"), "ok");
  EXPECT_EQ(next(device).width, 160U);
}

TEST_F(V4l2, FindsCamerasAndMakesNoScans) {
  ASSERT_NO_FATAL_FAILURE(plug_in({"GREY:160x120@100"}));
  if (IsSkipped()) {
    return;
  }
  EXPECT_THAT(v4l2::find_cameras(folder_.path()), testing::ElementsAre(testing::Pair(node(), "Virtual-1")));
  EXPECT_TRUE(v4l2::find_cameras("/no/such/folder").empty());
  EXPECT_TRUE((*registry_.find("v4l2"))->discover());
  Device device = open().value();
  EXPECT_FALSE(device.home());
  EXPECT_FALSE(device.trigger_frame());
  class : public ProfileSink {
    bool begin(const ScanInfo& /*info*/) override { return true; }
    bool profile(const Profile& /*profile*/) override { return true; }
    void end(const ScanTally& /*tally*/) override {}
  } sink;
  const auto scanned = device.scan(sink);
  ASSERT_FALSE(scanned);
  EXPECT_THAT(scanned.error().line(), HasSubstr("rig:FILE.toml"));
}

}  // namespace
}  // namespace dubsar
