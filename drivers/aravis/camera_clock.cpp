// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/camera_clock.h"

#include <algorithm>
#include <ctime>
#include <limits>

#include "drivers/aravis/glib.h"

namespace dubsar::aravis {

namespace {

// GigE Vision 2.0, bootstrap registers.
constexpr std::uint64_t kControl = 0x944;
constexpr std::uint64_t kValueHigh = 0x948;
constexpr std::uint64_t kValueLow = 0x94c;
constexpr std::uint32_t kLatch = 2;
constexpr int kTries = 8;
/// On a machine that is busy the answers come late: then it asks on until one came within this time.
constexpr int kMostTries = 40;
constexpr std::int64_t kSoon_ns = 1000000;
/// Longer than a frame can be on its way.
constexpr std::int64_t kLongest_ns = 1000000000;

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

}  // namespace

std::int64_t CameraClock::ours(std::int64_t camera_ns, std::int64_t arrived_ns) {
  const std::int64_t quickest = arrived_ns - camera_ns;
  if (!offset_) {
    const bool possible = asked_ && *asked_ <= quickest && quickest - *asked_ < kLongest_ns;
    offset_ = possible ? *asked_ : quickest;
  }
  offset_ = std::min(*offset_, quickest);
  return camera_ns + *offset_;
}

std::optional<std::int64_t> latched_offset_ns(ArvGvDevice* device) {
  GErrorHolder error;
  const std::uint64_t ticks_hz = arv_gv_device_get_timestamp_tick_frequency(device, error.fill());
  if (error || ticks_hz == 0) {
    return std::nullopt;
  }
  std::optional<std::int64_t> out;
  std::int64_t soonest = kLongest_ns;
  for (int k = 0; k < kTries || (k < kMostTries && soonest > kSoon_ns); ++k) {
    const std::int64_t asked = now_ns();
    arv_device_write_register(ARV_DEVICE(device), kControl, kLatch, error.fill());
    const std::int64_t answered = now_ns();
    guint32 high = 0;
    guint32 low = 0;
    if (!error) {
      arv_device_read_register(ARV_DEVICE(device), kValueHigh, &high, error.fill());
    }
    if (!error) {
      arv_device_read_register(ARV_DEVICE(device), kValueLow, &low, error.fill());
    }
    const std::uint64_t ticks = std::uint64_t{high} << 32U | low;
    if (error || ticks == 0) {
      return std::nullopt;
    }
    // In two parts: ticks times 1e9 does not fit.
    const auto camera =
        static_cast<std::int64_t>(ticks / ticks_hz * 1000000000 + ticks % ticks_hz * 1000000000 / ticks_hz);
    if (answered - asked < soonest) {
      soonest = answered - asked;
      out = asked + (answered - asked) / 2 - camera;
    }
  }
  return out;
}

}  // namespace dubsar::aravis
