// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The guard of a laser whose controller has power of its own, from the pull of its cable on: nobody asks the
// device for anything meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/drivers/usb_stage_fixture.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using test::UsbStage;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Not just any of its kind, as it was opened.
constexpr const char* kThisOne = "2341:0043:SN-42";

/// The controllers of the guards that this program has, as they were told.
std::vector<std::string> guards() {
  std::vector<std::string> out;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    std::string number, name, state, parent, program, controller;
    std::ifstream(process.path() / "stat") >> number >> name >> state >> parent;
    if (name == "(usb_stage_guard)" && state != "Z" && parent == std::to_string(::getpid())) {
      std::ifstream words(process.path() / "cmdline");
      std::getline(std::getline(words, program, '\0'), controller, '\0');
      out.push_back(controller);
    }
  }
  return out;
}

class Guarded : public UsbStage, public testing::WithParamInterface<const char*> {
 protected:
  static void unplug(Device& device) {
    ASSERT_EQ(peer()->tell("unplug"), "ok");
    const auto gone = device.motion();
    ASSERT_FALSE(gone);
    EXPECT_THAT(gone.error().line(), HasSubstr("pull the plugs"));
    ASSERT_EQ(laser(), "1");
  }
  static test::PeerProcess* peer() { return test::peer(); }
};

TEST_P(Guarded, ACableThatComesBackFindsTheLaserOffBeforeAnybodyAsks) {
  Device device = homed(open(GetParam()));
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(device.set_laser(0, 1));
    EXPECT_THAT(guards(), ElementsAre(kThisOne));
    unplug(device);
    EXPECT_THAT(guards(), ElementsAre(kThisOne));
    if (round > 0) {  // the program looks for it as well
      EXPECT_FALSE(device.motion());
      EXPECT_FALSE(device.set_laser(0, 1));
      EXPECT_THAT(guards(), ElementsAre(kThisOne));
    }
    ASSERT_EQ(peer()->tell("rejoin"), "ok");
    wait_for_dark();
    const auto back = device.motion();
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_THAT(guards(), IsEmpty());
  }
}

/// Two that talk on one line take each other's answers.
TEST_P(Guarded, OnceTheProgramHasItBackNobodyElseTalksToIt) {
  Device device = homed(open(GetParam()));
  ASSERT_TRUE(device.set_laser(0, 1));
  unplug(device);
  ASSERT_EQ(peer()->tell("rejoin"), "ok");
  const auto back = device.motion();  // at the same time as the guard
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(laser(), "0");
  EXPECT_THAT(guards(), IsEmpty());
  ASSERT_TRUE(device.set_laser(0, 1));
  for (const auto until = std::chrono::steady_clock::now() + 1s; std::chrono::steady_clock::now() < until;) {
    const auto now = device.motion();
    ASSERT_TRUE(now) << now.error().line();
    ASSERT_EQ(laser(), "1");
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Guarded, testing::Values("grbl", "horus", "tmcl"),
                         [](const auto& one) { return std::string(one.param); });

/// It takes people longer than some seconds to come to a cable.
TEST_F(UsbStage, TheGuardWaitsForACableLongAfterTheDeviceIsClosed) {
  {
    Device device = homed(open("grbl"));
    ASSERT_TRUE(device.set_laser(0, 1));
    ASSERT_EQ(test::peer()->tell("unplug"), "ok");
    ASSERT_FALSE(device.motion());
  }
  std::this_thread::sleep_for(12s);
  ASSERT_EQ(laser(), "1");
  ASSERT_EQ(test::peer()->tell("rejoin"), "ok");
  wait_for_dark();
}

}  // namespace
}  // namespace dubsar
