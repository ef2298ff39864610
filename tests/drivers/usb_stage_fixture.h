// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A controller that is emulated at the kernel's USB interface (umockdev), plugged in for one test.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "build_paths.h"
#include "drivers/loader.h"
#include "tests/support/peer_process.h"

namespace dubsar::test {

inline const std::filesystem::path kDrivers = std::filesystem::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers";
inline constexpr const char* kController = "2341:0043";
using StageOptions = std::vector<std::pair<std::string, std::string>>;

/// nullptr where umockdev does not work; then the tests are skipped.
inline PeerProcess* peer() {
  static const char* handed_over = std::getenv("DUBSAR_TEST_PEER");
  static PeerProcess* one =
      handed_over == nullptr ? nullptr : new PeerProcess(PeerProcess::HandedOver{handed_over});
  return one;
}

inline StageOptions options_of(const std::string& firmware) {
  return firmware == "tmcl" ? StageOptions{{"firmware", "tmcl"},
                                           {"steps", "1000"},
                                           {"speed_max", "50"},
                                           {"limits", "-10..100"}}
                            : StageOptions{};
}

class UsbStage : public testing::Test {
 protected:
  void SetUp() override {
    if (peer() == nullptr) {
      GTEST_SKIP() << "no emulated USB controller: umockdev's library cannot be preloaded here";
    }
    ASSERT_EQ(peer()->tell("plug"), "ok");
  }
  Result<Device> open(const std::string& firmware) {
    EXPECT_EQ(peer()->tell("firmware " + firmware), "ok");
    return (*registry_.find("usb_stage"))->open(kController, options_of(firmware));
  }
  static Device homed(Result<Device> opened) {
    Device device = std::move(opened).value();
    if (device.axes()->front().can_home) {
      const Status homed = device.home();
      EXPECT_TRUE(homed) << homed.error().line();
    }
    return device;
  }
  static std::string laser() { return peer()->tell("laser"); }
  static double at() { return std::stod(peer()->tell("at")); }
  /// Waits for what another process does; the test's own time limit ends a wait in vain.
  static void wait_for_dark() {
    while (laser() != "0") {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  DriverRegistry registry_{{kDrivers}};
};

}  // namespace dubsar::test
