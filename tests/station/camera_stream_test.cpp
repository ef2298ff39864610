// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a person sees through a camera, in the light that was asked for, and what they change meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "acquisition/rig_device.h"
#include "station/camera_watch.h"
#include "tests/acquisition/rig_bench.h"
#include "tests/sim/scenes.h"

namespace dubsar {
namespace {

/// The bench's camera, of which nothing but the exposure can be changed while frames run.
struct FixedBench : test::RigBench {
  int starts = 0;
  bool runs = false;
  std::atomic<bool> pressed = false;  ///< the emergency stop
  bool went_dark = false;             ///< before the camera came back
};

const dubsar_driver& fixed_camera_driver() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = test::camera_driver();
    out.start_frames = [](dubsar_device* device, std::uint32_t, dubsar_error*) -> std::int32_t {
      auto& bench = static_cast<FixedBench&>(test::bench_of(device));
      bench.runs = true;
      ++bench.starts;
      return DUBSAR_OK;
    };
    out.stop_frames = [](dubsar_device* device, dubsar_error*) -> std::int32_t {
      static_cast<FixedBench&>(test::bench_of(device)).runs = false;
      return DUBSAR_OK;
    };
    out.set_setting = [](dubsar_device* device, const char* key, const dubsar_value* value,
                         dubsar_error* error) -> std::int32_t {
      const auto& bench = static_cast<FixedBench&>(test::bench_of(device));
      return bench.runs && std::string_view(key) != "exposure_us"
                 ? plugin::report(error, DUBSAR_USAGE, std::string(key) + " cannot change while frames run")
                 : test::camera_driver().set_setting(device, key, value, error);
    };
    return out;
  }();
  return driver;
}

/// The bench's camera, gone in the moment in which the emergency stop is pressed: a call for a frame of it
/// comes back late, after the laser is off or nobody has put it off.
const dubsar_driver& hung_camera_driver() {
  static const dubsar_driver driver = [] {
    dubsar_driver out = test::camera_driver();
    out.next_frame = [](dubsar_device* device, std::uint32_t, dubsar_frame*, dubsar_error*) -> std::int32_t {
      auto& bench = static_cast<FixedBench&>(test::bench_of(device));
      bench.pressed = true;
      const auto is_lit = [&bench] {
        const std::scoped_lock lock(bench.line);
        return bench.laser > 0;
      };
      const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
      while (is_lit() && std::chrono::steady_clock::now() < patience) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      bench.went_dark = !is_lit();
      return DUBSAR_TIMEOUT;
    };
    return out;
  }();
  return driver;
}

class CameraStreamTest : public testing::Test {
 protected:
  CameraStreamTest() {
    test::set_up_small(bench_, scene_.scene);
    bench_.settable = true;
  }
  Device camera() { return camera(fixed_camera_driver()); }
  Device camera(const dubsar_driver& driver) {
    return {&driver, reinterpret_cast<dubsar_device*>(static_cast<test::RigBench*>(&bench_)),
            "bench_camera:"};
  }
  Device rig() { return rig(camera()); }
  Device rig(Device seen_by) {
    RigFile file;
    file.name = "bench rig";
    file.start = -0.5;
    file.step = 0.1;
    file.rows = 11;
    Result<RigScanner> made =
        RigScanner::make(file, bench_.truth, std::move(seen_by), test::stage_of(bench_), "rig.toml");
    EXPECT_TRUE(made) << made.error().line();
    return device_of(std::move(*made), "rig:rig.toml");
  }
  /// What was shown last.
  [[nodiscard]] const CameraView& last() const { return *seen_.back(); }

  sim::TestScene scene_{sim::plane(20, 0.5F, 0.5F)};
  FixedBench bench_;
  std::vector<std::shared_ptr<const CameraView>> seen_;
  EventSink sink_ = [this](const Event& event) {
    if (const auto* frame = std::get_if<CameraFrame>(&event); frame && frame->view) {
      seen_.push_back(frame->view);
    }
  };
};

TEST_F(CameraStreamTest, ARigIsSeenWithItsLaserOnOrOff) {
  Device device = rig();
  {
    CameraStream stream(device, sink_);
    ASSERT_TRUE(stream.show());
    EXPECT_EQ(last().lit, true);
    EXPECT_TRUE(last().exposure.has_stripe);
    stream.light(false);
    bench_.stale = 3;  // frames that the camera holds, of another light
    ASSERT_TRUE(stream.show());
    EXPECT_EQ(last().lit, false);
    EXPECT_FALSE(last().exposure.has_stripe);
    EXPECT_EQ(bench_.laser, 0);
    EXPECT_EQ(bench_.stale, 0);
    ASSERT_TRUE(stream.show());
    EXPECT_EQ(last().lit, false);
    stream.light(true);
    ASSERT_TRUE(stream.show());
    EXPECT_EQ(last().lit, true);
    EXPECT_TRUE(last().exposure.has_stripe);
  }
  EXPECT_EQ(bench_.laser, 0);
}

TEST_F(CameraStreamTest, ALaserThatCannotBePutOffWhenNobodyLooksAnyMoreIsTold) {
  Device device = rig();
  std::vector<std::string> notices;
  const EventSink sink = [&](const Event& event) {
    if (const auto* notice = std::get_if<Notice>(&event)) {
      notices.push_back(notice->text);
    }
  };
  {
    CameraStream stream(device, sink);
    ASSERT_TRUE(stream.show());
    bench_.burns_on = true;
  }
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("the laser may still be on"), std::string::npos) << notices[0];
  EXPECT_NE(notices[0].find("pull its plug"), std::string::npos) << notices[0];
}

TEST_F(CameraStreamTest, TheEmergencyStopPutsTheLaserOffAlsoWhileTheCameraDoesNotComeBack) {
  Device device = rig(camera(hung_camera_driver()));
  {
    CameraStream stream(device, sink_, {}, &bench_.pressed);
    ASSERT_TRUE(stream.show());
    EXPECT_TRUE(bench_.went_dark);
  }
  EXPECT_EQ(bench_.laser, 0);
  EXPECT_NE(bench_.asked.find('E'), std::string::npos) << bench_.asked;
}

TEST_F(CameraStreamTest, OfACameraAloneNobodyKnowsTheLight) {
  Device device = camera();
  CameraStream stream(device, sink_);
  stream.light(false);
  ASSERT_TRUE(stream.show());
  EXPECT_EQ(last().lit, std::nullopt);
  EXPECT_EQ(bench_.asked, "") << "of the stage";
}

TEST_F(CameraStreamTest, WhatCannotChangeWhileFramesRunEndsThemForTheChange) {
  bench_.part = {{"width_px", bench_.truth.camera.width},
                 {"height_px", bench_.truth.camera.height},
                 {"offset_x_px", 0},
                 {"offset_y_px", 0}};
  Device device = camera();
  CameraStream stream(device, sink_);
  ASSERT_TRUE(stream.show());
  // An exposure is tried out while one looks.
  ASSERT_TRUE(stream.put({{"exposure_us", "900"}}, "camera"));
  EXPECT_TRUE(bench_.runs);
  const Status put = stream.put({{"width_px", "128"}}, "camera");
  ASSERT_TRUE(put) << put.error().line();
  ASSERT_TRUE(stream.show());
  EXPECT_EQ(last().image->width, 128);
  EXPECT_EQ(bench_.starts, 2);
  // What it takes in no case is refused as ever, and the picture comes again.
  EXPECT_FALSE(stream.put({{"width_px", "100000"}}, "camera"));
  ASSERT_TRUE(stream.show());
  EXPECT_TRUE(bench_.runs);
}

}  // namespace
}  // namespace dubsar
