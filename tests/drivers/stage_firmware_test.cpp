// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a stage's firmwares do differently from one another, each of them simulated and without any line of
// USB.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>
#include <thread>
#include <utility>

#include "core/units.h"
#include "drivers/usb_stage/controller.h"
#include "tests/drivers/peers/firmware_sims.h"
#include "tests/support/comma_locale.h"

namespace dubsar::usb_stage {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

double seconds() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// A board on the table: it keeps its state whoever opens it.
class Board {
 public:
  explicit Board(const std::string& firmware) : sim_(test::make_firmware_sim(firmware)) {}

  void hear(std::string_view bytes) {
    const std::lock_guard lock(mutex_);
    sim_->take(bytes, seconds());
  }
  std::string said() {
    hear({});
    const std::lock_guard lock(mutex_);
    return std::exchange(sim_->out, {});
  }
  [[nodiscard]] double at() const { return sim_->at(seconds()); }
  [[nodiscard]] bool moving() const { return sim_->moving(seconds()); }
  [[nodiscard]] double laser() const { return sim_->laser; }

 private:
  std::mutex mutex_;
  std::unique_ptr<test::FirmwareSim> sim_;
};

class BoardLink : public Link {
 public:
  explicit BoardLink(Board& board) : board_(board) {}
  Status write(std::string_view bytes) override {
    board_.hear(bytes);
    return {};
  }
  Result<std::string> read(std::chrono::milliseconds timeout) override {
    const Clock::time_point until = Clock::now() + timeout;
    std::string bytes = board_.said();
    while (bytes.empty() && Clock::now() < until) {
      std::this_thread::sleep_for(1ms);
      bytes = board_.said();
    }
    return bytes;
  }

 private:
  Board& board_;
};

using Maker = std::function<std::unique_ptr<Firmware>(Link&)>;

std::unique_ptr<Firmware> grbl(Link& link) {
  return make_grbl(link, {{.name = "x", .rotary = false, .limits = {{-150, -1}}}}, "bench");
}
std::unique_ptr<Firmware> horus(Link& link) {
  return make_horus(link, {{.name = "x", .rotary = true, .limits = {}}}, "bench");
}
/// Two axes of 1000 steps per mm, no switches.
std::unique_ptr<Firmware> tmcl_of(Link& link, const std::vector<AxisWish>& axes) {
  TmclOptions options;
  options.steps = {1000, 1000};
  options.speeds_max = {50, 50};
  options.switches = false;
  return make_tmcl(link, axes, options, "bench");
}
std::unique_ptr<Firmware> tmcl(Link& link) {
  const AxisWish wish{.name = "x", .rotary = false, .limits = {{-1000, 1000}}};
  return tmcl_of(link, {wish, wish});
}

std::unique_ptr<Controller> open(Board& board, const Maker& firmware) {
  Result<std::unique_ptr<Controller>> opened = Controller::open(
      {.link = [&board]() -> Result<std::unique_ptr<Link>> { return std::make_unique<BoardLink>(board); },
       .firmware = [firmware](Link& link) -> Result<std::unique_ptr<Firmware>> { return firmware(link); },
       .guard = {}},
      "bench");
  EXPECT_TRUE(opened) << opened.error().line();
  return std::move(opened).value();
}

/// GRBL keeps its alarm over a reset: nothing but $X ends that of a stage that cannot be homed.
TEST(StageFirmware, GrblWithoutSwitchesMovesAgainWhenItIsOpenedAnew) {
  Board board("grbl-without-switches");
  {
    const auto controller = open(board, grbl);
    ASSERT_TRUE(controller->move(0, -100, 5, true));
    ASSERT_TRUE(controller->emergency_stop());
    EXPECT_FALSE(board.moving());
    for (const Status& refused : {controller->move(0, -5, 50, false), controller->set_laser(0, 1)}) {
      ASSERT_FALSE(refused);
      EXPECT_THAT(refused.error().line(), HasSubstr("emergency stop was pressed; open the device anew"));
    }
    EXPECT_THAT(controller->home().error().line(), HasSubstr("homing is not enabled in its settings"));
  }
  const auto controller = open(board, grbl);
  const Status moved = controller->move(0, -5, 50, false);
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_EQ(board.at(), -5);
  EXPECT_TRUE(controller->set_laser(0, 1));
}

/// In alarm it takes no M5: people were told to pull the plug of a laser that was off.
TEST(StageFirmware, GrblThatIsLockedPutsItsLaserOff) {
  Board board("grbl");
  const auto controller = open(board, grbl);
  ASSERT_TRUE(controller->home());
  ASSERT_TRUE(controller->set_laser(0, 1));
  ASSERT_TRUE(controller->move(0, -100, 5, true));
  ASSERT_TRUE(controller->emergency_stop());
  ASSERT_TRUE(controller->read()->position.alarm);
  const Status off = controller->set_laser(0, 0);
  EXPECT_TRUE(off) << off.error().line();
  EXPECT_EQ(board.laser(), 0);
  // That has not unlocked it.
  EXPECT_TRUE(controller->read()->position.alarm);
  ASSERT_TRUE(controller->home());
  EXPECT_TRUE(controller->set_laser(0, 1));
  EXPECT_EQ(board.laser(), 1);
}

/// With "S500,000" the controller knows no such command, and one that reads on lights its laser otherwise.
TEST(StageFirmware, GrblDimsItsLaserWhateverTheHostsLocale) {
  const test::CommaLocale comma;
  if (!test::CommaLocale::is_set()) {
    GTEST_SKIP() << "no locale with a decimal comma can be made here";
  }
  Board board("grbl-without-switches");
  const auto controller = open(board, grbl);
  const Status lit = controller->set_laser(0, 0.5);
  ASSERT_TRUE(lit) << lit.error().line();
  EXPECT_EQ(board.laser(), 0.5);
}

TEST(StageFirmware, ARefusedHomingLeavesTheLaserOnAndSaysSo) {
  for (const auto& [name, firmware] : {std::pair("horus", Maker(horus)), std::pair("tmcl", Maker(tmcl)),
                                       std::pair("grbl-without-switches", Maker(grbl))}) {
    Board board(name);
    const auto controller = open(board, firmware);
    ASSERT_TRUE(controller->set_laser(0, 1)) << name;
    EXPECT_EQ(controller->home().error().kind, ErrorKind::kUsage) << name;
    EXPECT_EQ(board.laser(), 1) << name;
    EXPECT_EQ(controller->read()->power[0], 1) << name;
  }
}

/// A Trinamic module knows no end of its own: a slide would run into its stop, a turntable goes round.
TEST(StageFirmware, ATrinamicAxisThatDoesNotTurnNeedsLimits) {
  const AxisWish table{.name = "y", .rotary = true, .limits = {}};
  for (const bool limited : {false, true}) {
    AxisWish slide{.name = "x", .rotary = false, .limits = {}};
    if (limited) {
      slide.limits = {-5, 5};
    }
    Board board("tmcl");
    BoardLink link(board);
    const std::unique_ptr<Firmware> firmware = tmcl_of(link, {slide, table});
    const Status connected = firmware->connect();
    ASSERT_EQ(connected.has_value(), limited);
    if (!limited) {
      EXPECT_EQ(connected.error().kind, ErrorKind::kUsage);
      EXPECT_THAT(connected.error().line(), HasSubstr("give limits= in mm for each axis that does not turn"));
      continue;
    }
    EXPECT_FALSE(firmware->axes()[0].endless);
    EXPECT_TRUE(firmware->axes()[1].endless);
  }
}

/// A Trinamic module that is stopped keeps the target that it no longer goes to.
TEST(StageFirmware, AStopOfOneAxisLeavesTheOtherFreeToMove) {
  Board board("tmcl");
  const auto controller = open(board, tmcl);
  ASSERT_TRUE(controller->move(1, 20, 5, true));
  EXPECT_TRUE(controller->read()->position.moving);
  ASSERT_TRUE(controller->stop());
  EXPECT_FALSE(controller->read()->position.moving);
  const Status moved = controller->move(0, 2, 50, false);
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_EQ(board.at(), 2000);
  const Status other = controller->move(1, 1, 50, false);
  EXPECT_TRUE(other) << other.error().line();
}

/// What is heavy, or brakes gently, needs longer than anybody waits for.
TEST(StageFirmware, AMotorThatStillTurnsIsNotCalledStopped) {
  Board board("tmcl-heavy");
  auto controller = open(board, tmcl);
  ASSERT_TRUE(controller->set_laser(0, 1));
  ASSERT_TRUE(controller->move(0, -500, 5, true));
  for (const Status& stopped : {controller->stop(), controller->emergency_stop()}) {
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kDevice);
  }
  EXPECT_TRUE(board.moving());
  EXPECT_EQ(board.laser(), 0);
  // Nor does one that is opened meanwhile say that it stands.
  const auto unsure = controller->read();
  ASSERT_FALSE(unsure);
  EXPECT_THAT(unsure.error().line(), HasSubstr("the motor still turns"));
  while (board.moving()) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(controller->read());
  EXPECT_TRUE(controller->stop());
}

/// It can only be reset, and counts from there: its limits are still those about where it was opened.
TEST(StageFirmware, ATurntableThatIsStoppedOnItsWayKeepsItsZero) {
  const Maker limited = [](Link& link) {
    return make_horus(link, {{.name = "x", .rotary = true, .limits = {{-90, 90}}}}, "bench");
  };
  for (const char* name : {"horus", "horus-silent", "horus-silent-quick"}) {
    Board board(name);
    const auto controller = open(board, limited);
    ASSERT_TRUE(controller->move(0, rad_from_deg(80), rad_from_deg(100), true));
    while (controller->read()->position.axes[0] < rad_from_deg(30)) {
    }
    ASSERT_TRUE(controller->stop());
    const double there = deg_from_rad(controller->read()->position.axes[0]);
    EXPECT_GE(there, 30 - 1e-9) << name;
    EXPECT_LT(there, 80) << name;
    EXPECT_EQ(board.at(), 0) << name << ": as it counts itself";
    const Status moved = controller->move(0, rad_from_deg(85), rad_from_deg(400), false);
    ASSERT_TRUE(moved) << name << ": " << moved.error().line();
    EXPECT_NEAR(board.at(), 85 - there, 1e-3) << name;
    EXPECT_NEAR(controller->read()->position.axes[0], rad_from_deg(85), 1e-4) << name;
    EXPECT_EQ(controller->move(0, rad_from_deg(91), 0, true).error().kind, ErrorKind::kUsage) << name;
    // Another stop at rest changes nothing.
    ASSERT_TRUE(controller->stop());
    EXPECT_NEAR(controller->read()->position.axes[0], rad_from_deg(85), 1e-4) << name;
    // An emergency stop has reset it before anybody asked where it was: by its speed.
    ASSERT_TRUE(controller->move(0, rad_from_deg(-80), rad_from_deg(100), true));
    while (controller->read()->position.axes[0] > rad_from_deg(40)) {
    }
    ASSERT_TRUE(controller->emergency_stop());
    EXPECT_LE(controller->read()->position.axes[0], rad_from_deg(40)) << name;
    EXPECT_GT(controller->read()->position.axes[0], rad_from_deg(-80)) << name;
  }
}

/// Neither a report nor an ok says when it stands: the time that the way takes does.
TEST(StageFirmware, ATurntableThatSaysNothingOnTheWayIsWaitedFor) {
  Board board("horus-silent-quick");
  const auto controller = open(board, horus);
  const Status moved = controller->move(0, rad_from_deg(30), rad_from_deg(150), false);
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_FALSE(board.moving()) << board.at();
  ASSERT_TRUE(controller->move(0, rad_from_deg(90), rad_from_deg(2), true));
  EXPECT_TRUE(controller->read()->position.moving);
  ASSERT_TRUE(controller->stop());
  EXPECT_FALSE(board.moving()) << board.at();
  EXPECT_FALSE(controller->read()->position.moving);
}

/// The time that a move may take is reckoned from what is left of it.
TEST(StageFirmware, ATurntableThatDoesNotReportIsWhereItsSpeedHasIt) {
  for (const char* name : {"horus-silent", "horus-silent-quick"}) {
    Board board(name);
    const auto controller = open(board, horus);
    ASSERT_TRUE(controller->move(0, rad_from_deg(90), rad_from_deg(2), true));
    const auto now = controller->read();
    ASSERT_TRUE(now) << now.error().line();
    EXPECT_TRUE(now->position.moving) << name;
    EXPECT_TRUE(now->position.commanded) << name;
    EXPECT_GT(now->position.axes[0], 0) << name;
    EXPECT_LT(now->position.axes[0], rad_from_deg(90)) << name;
  }
}

}  // namespace
}  // namespace dubsar::usb_stage
