// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/driver_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

#include "build_paths.h"
#include "drivers/driver.h"
#include "drivers/frame.h"
#include "drivers/loader.h"
#include "tests/support/in_child.h"

namespace dubsar {
namespace {

TEST(DriverCall, TheOneThatBeganFirstIsTold) {
  EXPECT_FALSE(longest_driver_call());
  {
    const DriverCall rig("rig:museum.toml");
    const auto before = longest_driver_call();
    ASSERT_TRUE(before);
    std::jthread([] {
      const DriverCall camera("v4l2:/dev/video0");
      ASSERT_TRUE(longest_driver_call());
      EXPECT_EQ(longest_driver_call()->device, "rig:museum.toml");
    }).join();
    EXPECT_EQ(longest_driver_call()->since, before->since);
  }
  EXPECT_FALSE(longest_driver_call());
}

TEST(DriverCall, AnExitWithinOneIsAFailureOfTheDevice) {
  EXPECT_EQ(test::in_child([] {
              const DriverCall call("evil:1");
              std::exit(0);
              return 1;
            }),
            3);
  EXPECT_EQ(test::in_child([] {
              { const DriverCall call("good:1"); }
              std::exit(5);
              return 1;
            }),
            5)
      << "none is under way";
}

TEST(DriverCall, AnExitNamesTheDriverOfItsOwnThread) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const int status = test::in_child([&] {
    ::dup2(ends[1], STDERR_FILENO);
    const DriverCall camera("camera:1");
    std::thread([] {
      const DriverCall rig("rig:1");
      { const DriverCall light("light:1"); }
      const DriverCall stage("stage:1");
      std::exit(0);
    }).join();
    return 1;
  });
  ::close(ends[1]);
  EXPECT_EQ(status, 3);
  std::string said(1000, ' ');
  said.resize(static_cast<std::size_t>(std::max<ssize_t>(::read(ends[0], said.data(), said.size()), 0)));
  ::close(ends[0]);
  EXPECT_THAT(said, ::testing::StartsWith("dubsar: stage:1: the driver ended the program"));
}

TEST(DriverCall, GivingAFrameBackIsOne) {
  static std::string during;
  dubsar_driver driver{};
  driver.scheme = "camera";
  driver.release_frame = [](dubsar_device*, std::uint64_t) {
    const auto call = longest_driver_call();
    during = call ? call->device : std::string();
  };
  int device = 0;
  {
    const FrameLease lease(&driver, {reinterpret_cast<dubsar_device*>(&device), [](dubsar_device*) {}}, 1);
  }
  EXPECT_EQ(during, "camera");
  EXPECT_FALSE(longest_driver_call());
}

/// What is known while its rows come.
class Looker : public ProfileSink {
 public:
  bool begin(const ScanInfo& /*info*/) override { return true; }
  bool profile(const Profile& /*profile*/) override {
    const auto call = longest_driver_call();
    device = call ? call->device : std::string();
    return false;
  }
  void end(const ScanTally& /*tally*/) override {}
  std::string device;
};

TEST(DriverCall, AScanIsOneForAsLongAsItLasts) {
  const DriverRegistry registry({DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/example"});
  const Result<const Driver*> plate = registry.find("plate");
  ASSERT_TRUE(plate) << plate.error().line();
  {
    Result<Device> device = (*plate)->open("1", {});
    ASSERT_TRUE(device) << device.error().line();
    EXPECT_FALSE(longest_driver_call()) << "it is open, and asked for nothing";
    Looker looker;
    EXPECT_FALSE(device->scan(looker));
    EXPECT_EQ(looker.device, "plate:1");
  }
  EXPECT_FALSE(longest_driver_call());
}

}  // namespace
}  // namespace dubsar
