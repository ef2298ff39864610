// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <utility>

#include "drivers/loader.h"

namespace dubsar::test {

/// The device's next frame, which has to come.
inline Frame next_frame(Device& device) {
  auto frame = device.next_frame(std::chrono::seconds(20));
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().line());
  EXPECT_TRUE(frame && *frame);
  return frame && *frame ? std::move(**frame) : Frame{};
}

}  // namespace dubsar::test
