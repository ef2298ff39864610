// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>

#include "core/gray_image.h"
#include "core/result.h"
#include "drivers/device.h"

namespace dubsar {

/// Ends the stream of frames when it goes.
class StreamGuard {
 public:
  explicit StreamGuard(Device& camera) : camera_(camera) {}
  StreamGuard(const StreamGuard&) = delete;
  StreamGuard& operator=(const StreamGuard&) = delete;
  ~StreamGuard() { [[maybe_unused]] const Status said = camera_.stop_frames(); }

 private:
  Device& camera_;
};

/// A whole frame of a camera that streams, whose light fell after this was called. Errors: kDevice when the
/// camera is gone, or none came in 5 s; kCancelled soon after stopped() is true.
[[nodiscard]] Result<Frame> fresh_frame(Device& camera, const std::function<bool()>& stopped);

/// A copy with 8 bits a pixel: of more bits the highest eight.
[[nodiscard]] GrayImage gray_of(const Frame& frame);

}  // namespace dubsar
