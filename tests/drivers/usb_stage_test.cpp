// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The usb_stage: driver against controllers that are emulated at the kernel's USB interface (umockdev), with
// firmware whose motors take their time. umockdev works by a preloaded library: the program starts the peer,
// then becomes itself again with that library.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <future>
#include <random>

#include "core/units.h"
#include "tests/drivers/usb_stage_fixture.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

using test::kController;
using test::kDrivers;
using test::options_of;
using test::peer;
using test::StageOptions;
using test::UsbStage;

/// Each test with each firmware.
class Firmwares : public UsbStage, public testing::WithParamInterface<const char*> {
 protected:
  Device open_homed() { return homed(open(GetParam())); }
  /// Positions of the firmware in our units: GRBL counts down from its switch.
  static double target() {
    return std::string(GetParam()) == "grbl"    ? -5.0
           : std::string(GetParam()) == "horus" ? rad_from_deg(30)
                                                : 5.0;
  }
  static double firmware_units(double position) {
    return std::string(GetParam()) == "horus"  ? deg_from_rad(position)
           : std::string(GetParam()) == "tmcl" ? position * 1000
                                               : position;
  }
  static double step() { return std::string(GetParam()) == "tmcl" ? 2 : 0.01; }
  /// With its laser lit, half a minute from its end; returns once it is under way.
  std::future<Status> long_move(Device& device) {
    EXPECT_TRUE(device.set_laser(0, 1));
    std::future<Status> moving = std::async(std::launch::async, [&device] {
      return device.move(
          {.axis = 0, .position = target(), .speed = std::abs(target()) / 30, .start_only = false});
    });
    while (std::abs(at()) < step()) {
      std::this_thread::sleep_for(1ms);
    }
    return moving;
  }
};

TEST_P(Firmwares, MovesWhereItIsAskedAndSaysWhere) {
  Device device = open_homed();
  const DeviceCapabilities can = device.capabilities().value();
  EXPECT_TRUE(can.is_stage);
  EXPECT_FALSE(can.yields_scans);
  EXPECT_EQ(can.serial, "SN-42");
  EXPECT_THAT(can.model, HasSubstr("Stage peer, "));
  const StageAxis axis = device.axes()->front();
  const Status moved =
      device.move({.axis = 0, .position = target(), .speed = axis.speed_maximum, .start_only = false});
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_NEAR(at(), firmware_units(target()), step());
  const StageReading motion = device.motion().value();
  EXPECT_NEAR(motion.position.at(0), target(), std::max(2 * axis.resolution, 1e-3));
  EXPECT_FALSE(motion.moving);
  EXPECT_TRUE(motion.homed);
  EXPECT_FALSE(motion.commanded);
}

TEST_P(Firmwares, TellsPositionsWithTimesWhileItMoves) {
  Device device = open_homed();
  const double speed = std::abs(target()) / 0.3;
  ASSERT_TRUE(device.move({.axis = 0,
                           .position = target(),
                           .speed = std::min(speed, device.axes()->front().speed_maximum),
                           .start_only = true}));
  std::vector<StageReading> seen;
  do {
    seen.push_back(device.motion().value());
  } while (seen.back().moving);
  ASSERT_GT(seen.size(), 5U);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    EXPECT_GT(seen[k].timestamp_ns, seen[k - 1].timestamp_ns);
    EXPECT_GE(std::abs(seen[k].position[0]), std::abs(seen[k - 1].position[0]) - 1e-9);
    EXPECT_GE(seen[k].uncertainty_ns, 0);
  }
  EXPECT_NEAR(device.motion()->position[0], target(), 0.01);
}

TEST_P(Firmwares, LasersGoOnAndOff) {
  {
    Device device = open_homed();
    EXPECT_EQ(laser(), "0");
    ASSERT_TRUE(device.set_laser(0, 1.0));
    EXPECT_EQ(laser(), "1");
    EXPECT_EQ(device.motion()->laser[0], 1.0);
    ASSERT_TRUE(device.set_laser(0, 0));
    EXPECT_EQ(laser(), "0");
    EXPECT_FALSE(device.set_laser(7, 1));
    EXPECT_FALSE(device.set_laser(0, 1.5));
    ASSERT_TRUE(device.set("laser_0", 1.0));
    EXPECT_EQ(laser(), "1");
    ASSERT_TRUE(device.stop());
    EXPECT_EQ(laser(), "0");
    ASSERT_TRUE(device.set_laser(0, 1.0));
  }
  EXPECT_EQ(laser(), "0");  // closed
}

TEST_P(Firmwares, KeepsItsLimits) {
  Device device = open_homed();
  const StageAxis axis = device.axes()->front();
  const double before = at();
  for (const StageMove& move :
       {StageMove{0, axis.maximum + 1, 0, false}, StageMove{0, axis.minimum - 1, 0, false},
        StageMove{0, target(), 2 * axis.speed_maximum, false}, StageMove{5, 0, 0, false}}) {
    const Status refused = device.move(move);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  }
  EXPECT_EQ(at(), before);
}

TEST_P(Firmwares, AMoveEndsWhenAnotherThreadSaysStop) {
  Device device = open_homed();
  std::future<Status> moving = long_move(device);
  const Status stopped = device.stop();
  EXPECT_TRUE(stopped) << stopped.error().line();
  const Status moved = moving.get();
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().kind, ErrorKind::kCancelled) << moved.error().line();
  EXPECT_EQ(laser(), "0");
  const double here = at();
  EXPECT_LT(std::abs(here), std::abs(firmware_units(target())));
  EXPECT_EQ(at(), here);
  const Status again = device.move({.axis = 0, .position = target(), .speed = 0, .start_only = false});
  EXPECT_TRUE(again) << again.error().line();
}

/// GRBL and Horus would obey behind the move, half a minute later.
TEST_P(Firmwares, ALaserIsPutOffAtOnceEvenIfThatEndsTheMove) {
  Device device = open_homed();
  std::future<Status> moving = long_move(device);
  const Status dark = device.set_laser(0, 0);
  ASSERT_TRUE(dark) << dark.error().line();
  EXPECT_EQ(laser(), "0");
  EXPECT_LT(std::abs(at()), std::abs(firmware_units(target())));
  if (std::string(GetParam()) == "tmcl") {  // whose outputs wait for no motor
    EXPECT_TRUE(device.motion()->moving);
    EXPECT_TRUE(device.stop());
  }
  EXPECT_EQ(moving.get().error().kind, ErrorKind::kCancelled);
  EXPECT_FALSE(device.motion()->moving);
  const Status again = device.move({.axis = 0, .position = target(), .speed = 0, .start_only = false});
  EXPECT_TRUE(again) << again.error().line();
}

TEST_P(Firmwares, AfterAnEmergencyStopNothingMovesUntilHome) {
  Device device = open_homed();
  std::future<Status> moving = long_move(device);
  const Status halted = device.emergency_stop();
  EXPECT_TRUE(halted) << halted.error().line();
  EXPECT_EQ(laser(), "0");
  ASSERT_FALSE(moving.get());
  const double here = at();
  EXPECT_FALSE(device.move({.axis = 0, .position = target(), .speed = 0, .start_only = false}));
  EXPECT_THAT(device.set_laser(0, 1).error().line(), HasSubstr("emergency stop"));
  EXPECT_EQ(at(), here);
  if (device.axes()->front().can_home) {
    ASSERT_TRUE(device.home());
    EXPECT_TRUE(device.move({.axis = 0, .position = target(), .speed = 0, .start_only = false}));
  } else {
    EXPECT_EQ(device.home().error().kind, ErrorKind::kUsage);
  }
}

TEST_P(Firmwares, UnpluggedInMidMoveAndPluggedInAgain) {
  Device device = open_homed();
  std::mt19937 random(11);
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(device.set_laser(0, 1));
    ASSERT_TRUE(
        device.move({.axis = 0, .position = target(), .speed = std::abs(target()) / 30, .start_only = true}));
    for (auto looks = random() % 5; looks > 0; --looks) {
      ASSERT_TRUE(device.motion());
    }
    ASSERT_EQ(peer()->tell("unplug"), "ok");
    const auto gone = device.motion();
    ASSERT_FALSE(gone);
    EXPECT_EQ(gone.error().kind, ErrorKind::kDevice);
    EXPECT_THAT(gone.error().line(), HasSubstr("unplugged"));
    EXPECT_THAT(device.stop().error().line(), HasSubstr("pull the plugs"));  // nobody knows what it does
    EXPECT_FALSE(device.set_laser(0, 1));
    ASSERT_EQ(peer()->tell("plug"), "ok");
    const auto back = device.motion();
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(laser(), "0");
    if (device.axes()->front().can_home) {
      EXPECT_THAT(
          device.move({.axis = 0, .position = target(), .speed = 0, .start_only = false}).error().line(),
          HasSubstr("home it first"));
      ASSERT_TRUE(device.home());
    }
    ASSERT_TRUE(device.move({.axis = 0, .position = target() / 4, .speed = 0, .start_only = false}));
  }
}

TEST_P(Firmwares, ACableThatIsPulledLeavesNoLaserOnWhenTheDeviceCloses) {
  {
    Device device = open_homed();
    ASSERT_TRUE(device.set_laser(0, 1));
    ASSERT_EQ(peer()->tell("mute"), "ok");  // it hears, and does not answer
    EXPECT_FALSE(device.motion());
  }
  ASSERT_EQ(peer()->tell("talk"), "ok");
  wait_for_dark();
}

/// A controller with power of its own goes on burning the laser while the cable is out.
TEST_P(Firmwares, ACableThatComesBackFindsTheLaserOnAndPutsItOff) {
  Device device = open_homed();
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(device.set_laser(0, 1));
    ASSERT_EQ(peer()->tell("unplug"), "ok");
    ASSERT_FALSE(device.motion());
    ASSERT_EQ(laser(), "1");
    ASSERT_EQ(peer()->tell("rejoin"), "ok");
    const auto back = device.motion();
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(laser(), "0");
  }
}

TEST_P(Firmwares, GarbageAndImpossiblePositionsAreToldAsWhatTheyAre) {
  Device device = open_homed();
  ASSERT_EQ(peer()->tell("babble"), "ok");
  const auto through = device.motion();  // garbage between the lines harms nothing
  ASSERT_TRUE(through) << through.error().line();
  ASSERT_TRUE(device.set_laser(0, 1));
  ASSERT_EQ(peer()->tell("impossible"), "ok");
  const auto impossible = device.motion();
  ASSERT_FALSE(impossible);
  EXPECT_THAT(impossible.error().line(), HasSubstr("impossible position"));
  EXPECT_EQ(laser(), "0");
  ASSERT_EQ(peer()->tell("possible"), "ok");
  EXPECT_TRUE(device.motion());
}

TEST_P(Firmwares, AStuckMotorIsNoEndlessWait) {
  Device device = open_homed();
  ASSERT_TRUE(device.set_laser(0, 1));
  ASSERT_EQ(peer()->tell("stick"), "ok");
  const Status moved = device.move(
      {.axis = 0, .position = target(), .speed = device.axes()->front().speed_maximum, .start_only = false});
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().line(), HasSubstr("short of its target"));
  EXPECT_EQ(laser(), "0");
}

TEST_P(Firmwares, TheLaserGoesOffHoweverTheProgramDies) {
  for (const char* how : {"kill", "segv", "abort", "exit", "term", "stop"}) {
    ASSERT_EQ(peer()->tell(std::string("firmware ") + GetParam()), "ok");
    test::PeerProcess victim(std::vector<std::string>{"/proc/self/exe", "--die", GetParam(), how});
    ASSERT_EQ(victim.refusal(), "") << how;
    ASSERT_EQ(laser(), "1") << how;
    ASSERT_EQ(peer()->tell("dying"), "ok");
    ASSERT_EQ(victim.tell("now"), "none") << how;  // it is gone
    wait_for_dark();
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Firmwares, testing::Values("grbl", "horus", "tmcl"),
                         [](const auto& one) { return std::string(one.param); });

TEST_F(UsbStage, FindsControllers) {
  const auto found = (*registry_.find("usb_stage"))->discover().value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].uri, "usb_stage:2341:0043:SN-42");
  EXPECT_EQ(found[0].description, "Stage peer");
}

TEST_F(UsbStage, ATrinamicModuleWithoutSwitchesIsNotHomed) {
  ASSERT_EQ(peer()->tell("firmware tmcl"), "ok");
  StageOptions options = options_of("tmcl");
  options.emplace_back("switches", "no");
  Device device = (*registry_.find("usb_stage"))->open(kController, options).value();
  EXPECT_FALSE(device.axes()->front().can_home);
  EXPECT_THAT(device.home().error().line(), HasSubstr("without switches cannot be homed"));
  EXPECT_TRUE(device.move({.axis = 0, .position = 5, .speed = 0, .start_only = false}));
}

TEST_F(UsbStage, ARefusalSaysWhatToDo) {
  const Driver& driver = **registry_.find("usb_stage");
  EXPECT_EQ(driver.open("nonsense", {}).error().kind, ErrorKind::kUsage);
  EXPECT_THAT(driver.open("1111:2222", {}).error().line(), HasSubstr("unplugged or is not there"));
  EXPECT_THAT(driver.open("2341:0043:OTHER", {}).error().line(), HasSubstr("not there"));
  ASSERT_EQ(peer()->tell("firmware tmcl"), "ok");
  EXPECT_THAT(driver.open(kController, {}).error().line(), HasSubstr("firmware=tmcl"));
  EXPECT_THAT(driver.open(kController, {{"firmware", "tmcl"}}).error().line(), HasSubstr("steps="));
  ASSERT_EQ(peer()->tell("firmware grbl"), "ok");
  EXPECT_EQ(driver.open(kController, {{"firmware", "grbl"}, {"axes", "y:mm,q"}}).error().kind,
            ErrorKind::kUsage);
  Device device = driver.open(kController, {}).value();
  EXPECT_THAT(device.move({.axis = 0, .position = -5, .speed = 0, .start_only = false}).error().line(),
              HasSubstr("home it first"));
  EXPECT_FALSE(device.start_frames());
}

/// What the victims do.
int die(const std::string& firmware, const std::string& how) {
  const DriverRegistry registry({kDrivers});
  Result<Device> device = (*registry.find("usb_stage"))->open(kController, options_of(firmware));
  if (!device || (firmware != "horus" && !device->home()) || !device->set_laser(0, 1)) {
    std::printf("cannot: no laser: %s\n", device ? "" : device.error().line().c_str());
    return 1;
  }
  std::puts("ready");
  std::fflush(stdout);
  char line[16];
  [[maybe_unused]] const char* got = std::fgets(line, sizeof line, stdin);
  if (how == "exit") {
    std::_Exit(0);
  }
  if (how == "stop") {  // as Ctrl-Z does it
    std::raise(SIGSTOP);
  }
  std::raise(how == "kill" ? SIGKILL : how == "segv" ? SIGSEGV : how == "term" ? SIGTERM : SIGABRT);
  return 0;
}

}  // namespace
}  // namespace dubsar

int main(int count, char** words) {
  if (count == 4 && std::string(words[1]) == "--die") {
    return dubsar::die(words[2], words[3]);
  }
  const bool lists = count > 1 && std::string(words[1]) == "--gtest_list_tests";
  if (!lists && std::getenv("UMOCKDEV_DIR") == nullptr) {
    dubsar::test::PeerProcess one(std::vector<std::string>{DUBSAR_BINARY_DIR "/bin/usb_peer"});
    constexpr const char* kLibrary = "libumockdev-preload.so.0";
    if (one.refusal().empty() && ::dlopen(kLibrary, RTLD_LAZY) != nullptr) {
      // A sanitizer's library must come first of all.
      const std::string preload = std::string(DUBSAR_SANITIZER_LIBRARY) + kLibrary;
      ::setenv("LD_PRELOAD", preload.c_str(), 1);
      ::setenv("UMOCKDEV_DIR", one.greeting().c_str(), 1);
      ::setenv("DUBSAR_TEST_PEER", one.hand_over().c_str(), 1);
      ::execv("/proc/self/exe", words);
    }
  }
  testing::InitGoogleTest(&count, words);
  const int failed = RUN_ALL_TESTS();
  delete dubsar::test::peer();
  return failed;
}
