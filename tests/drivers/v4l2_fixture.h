// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A camera that the kernel serves through FUSE, plugged in for one test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "build_paths.h"
#include "drivers/loader.h"
#include "tests/drivers/next_frame.h"
#include "tests/support/peer_process.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

class V4l2Camera : public testing::Test {
 protected:
  using Options = std::vector<std::pair<std::string, std::string>>;

  void plug_in(std::vector<std::string> modes) {
    modes.insert(modes.begin(), {DUBSAR_BINARY_DIR "/bin/v4l2_peer", folder_.path().string(), "Virtual-1"});
    peer_.emplace(modes);
    if (!peer_->refusal().empty()) {
      GTEST_SKIP() << "no emulated camera: " << peer_->refusal();
    }
  }
  void TearDown() override { peer_.reset(); }
  [[nodiscard]] std::string node() const { return (folder_.path() / "video0").string(); }
  [[nodiscard]] Result<Device> open(const Options& options = {}) const {
    return (*registry_.find("v4l2"))->open(node(), options);
  }
  /// The brightness that the camera paints.
  static std::uint8_t painted(std::size_t x, std::size_t y) {
    return static_cast<std::uint8_t>(7 * x + 3 * y);
  }
  static std::uint32_t painted_number(const Frame& frame) {
    std::uint32_t out = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      out |= std::uint32_t{frame.pixels[k]} << (8 * k);
    }
    return out;
  }
  static Frame next(Device& device) { return next_frame(device); }
  /// With a pool of four, its first frame seen.
  [[nodiscard]] Device streaming() const {
    Device device = open({{"buffers", "4"}}).value();
    EXPECT_TRUE(device.start_frames());
    next(device);
    return device;
  }

  TemporaryFolder folder_;
  std::optional<PeerProcess> peer_;
  DriverRegistry registry_{{std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers"}};
};

}  // namespace dubsar::test
