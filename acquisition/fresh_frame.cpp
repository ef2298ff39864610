// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/fresh_frame.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace dubsar {

namespace {

constexpr auto kWait = std::chrono::milliseconds(200);
constexpr auto kAtMost = std::chrono::seconds(5);
/// Frames that a camera's queue holds at most: V4L2's.
constexpr int kQueued = 32;

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Result<Frame> fresh_frame(Device& camera, const std::function<bool()>& stopped) {
  std::int64_t not_before_ns = monotonic_ns();
  bool let_go = false;
  int may_wait = kQueued;
  const auto until = std::chrono::steady_clock::now() + kAtMost;
  while (std::chrono::steady_clock::now() < until) {
    if (stopped()) {
      return fail(ErrorKind::kCancelled, "stopped before a frame came", camera.uri());
    }
    const bool looks = may_wait > 0;
    Result<std::optional<Frame>> frame = camera.next_frame(looks ? std::chrono::milliseconds(0) : kWait);
    if (!frame) {
      return std::unexpected(frame.error());
    }
    // Where nothing but the taking stamps a frame, one that was there at once may be of any age.
    if (looks && *frame && !(*frame)->exposed && (*frame)->device_timestamp_ns == 0) {
      --may_wait;
      continue;
    }
    may_wait = 0;
    if (!*frame || (*frame)->timestamp_ns < not_before_ns || (*frame)->incomplete) {
      continue;
    }
    if ((*frame)->exposed || let_go) {
      return std::move(**frame);
    }
    // One that is stamped on arrival was exposed before: one whole frame is let go by then.
    let_go = true;
    not_before_ns = (*frame)->timestamp_ns + 1;
  }
  return fail(ErrorKind::kDevice, "no frame came from the camera in 5 s", camera.uri(),
              "see that its trigger is free, and the cable");
}

GrayImage gray_of(const Frame& frame) {
  GrayImage out(static_cast<int>(frame.width), static_cast<int>(frame.height));
  for (std::uint32_t v = 0; v < frame.height; ++v) {
    const std::uint8_t* const line = frame.pixels.data() + std::size_t{v} * frame.stride_bytes;
    std::uint8_t* const to = out.pixels.data() + out.index(0, static_cast<int>(v));
    if (frame.format == PixelFormat::kMono8) {
      std::memcpy(to, line, frame.width);
      continue;
    }
    for (std::uint32_t u = 0; u < frame.width; ++u) {
      std::uint16_t value = 0;
      std::memcpy(&value, line + std::size_t{2} * u, sizeof value);
      to[u] = static_cast<std::uint8_t>(std::min<std::uint32_t>(value, full_scale(frame.format)) * 255U /
                                        full_scale(frame.format));
    }
  }
  return out;
}

}  // namespace dubsar
