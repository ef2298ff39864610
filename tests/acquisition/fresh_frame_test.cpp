// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The first frame whose light fell after a move, of cameras that stamp their frames well or not at all.
#include "acquisition/fresh_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

#include "drivers/driver.h"
#include "drivers/plugin.h"

namespace dubsar {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t ns_of(Clock::time_point at) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(at.time_since_epoch()).count();
}

/// A camera of 50 frames a second with a queue, as V4L2 has it: what nobody has taken waits there.
struct QueueCamera {
  static constexpr std::chrono::milliseconds kPeriod{20};
  Clock::time_point started = Clock::now();
  int depth = 0;         ///< frames that wait when it is looked at first
  bool stamped = false;  ///< when a frame came; else a frame is stamped when it is taken
  int taken = 0;
  std::uint8_t pixel = 0;

  /// When frame `number` came: the last of those that wait did just now.
  [[nodiscard]] Clock::time_point came(int number) const { return started + (number - depth + 1) * kPeriod; }
};

QueueCamera& camera_of(dubsar_device* device) {
  return *reinterpret_cast<QueueCamera*>(device);
}

Device device_of(QueueCamera& camera) {
  static const dubsar_driver driver = [] {
    dubsar_driver out = plugin::empty_driver();
    out.scheme = "queue";
    out.close = [](dubsar_device*) {};
    out.start_frames = [](dubsar_device*, std::uint32_t, dubsar_error*) -> std::int32_t { return DUBSAR_OK; };
    out.stop_frames = [](dubsar_device*, dubsar_error*) -> std::int32_t { return DUBSAR_OK; };
    out.release_frame = [](dubsar_device*, std::uint64_t) {};
    out.frame_counters = [](dubsar_device*, dubsar_frame_counters*, dubsar_error*) -> std::int32_t {
      return DUBSAR_OK;
    };
    out.next_frame = [](dubsar_device* device, std::uint32_t timeout_ms, dubsar_frame* to,
                        dubsar_error*) -> std::int32_t {
      QueueCamera& is = camera_of(device);
      const Clock::time_point came = is.came(is.taken);
      const Clock::time_point until = Clock::now() + std::chrono::milliseconds(timeout_ms);
      std::this_thread::sleep_until(std::min(came, until));
      if (Clock::now() < came) {
        return DUBSAR_TIMEOUT;
      }
      dubsar_frame frame{};
      frame.struct_size = sizeof frame;
      frame.lease = frame.id = static_cast<std::uint64_t>(++is.taken);
      frame.timestamp_ns = ns_of(is.stamped ? came : Clock::now());
      frame.device_timestamp_ns = is.stamped ? frame.timestamp_ns : 0;
      frame.pixels = &is.pixel;
      frame.width = frame.height = frame.stride_bytes = 1;
      frame.size_bytes = 1;
      frame.pixel_format = DUBSAR_PIXEL_MONO8;
      plugin::lend(to, frame);
      return DUBSAR_OK;
    };
    return out;
  }();
  return {&driver, reinterpret_cast<dubsar_device*>(&camera), "queue:"};
}

/// Exposed at most a period before it came: so that it came a period after it was asked for is enough.
TEST(FreshFrame, NoneIsOfBeforeHoweverManyWaitUnstamped) {
  for (const bool stamped : {true, false}) {
    for (const int depth : {0, 1, 15, 32}) {
      QueueCamera camera;
      camera.depth = depth;
      camera.stamped = stamped;
      Device device = device_of(camera);
      const Clock::time_point asked = Clock::now();
      const Result<Frame> frame = fresh_frame(device, [] { return false; });
      ASSERT_TRUE(frame) << frame.error().line();
      EXPECT_GE(camera.came(static_cast<int>(frame->id) - 1), asked + QueueCamera::kPeriod)
          << "waiting: " << depth << ", stamped: " << stamped;
    }
  }
}

/// A camera whose queue fills faster than it is emptied, or that never makes anybody wait.
TEST(FreshFrame, AQueueThatNeverEndsIsNoEndlessWait) {
  QueueCamera camera;
  camera.depth = 1 << 20;
  Device device = device_of(camera);
  const Result<Frame> frame = fresh_frame(device, [] { return false; });
  ASSERT_TRUE(frame) << frame.error().line();
  EXPECT_LT(frame->id, 64);
}

}  // namespace
}  // namespace dubsar
