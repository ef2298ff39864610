// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A stage's controller that does what a sound one does not, without any line of USB.
#include "drivers/usb_stage/controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dubsar::usb_stage {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// What a firmware was made to do.
struct Bench {
  bool alarm = false;  ///< from the first move on
  bool finds_switch = true;
  double position = 0;
  double asked_position = 0, asked_speed = 0;
  double laser = 0;
  int stops = 0;
};

class BenchFirmware : public Firmware {
 public:
  explicit BenchFirmware(Bench& bench) : bench_(bench) {
    axes_ = {{"x", false, true, false, 10, 100, 50, 0.001, {0, 100}},
             {"y", true, true, false, -1, 1, 0.2, 0.001, {-1, 1}}};
    homed_ = true;
  }
  Status connect() override { return {}; }
  Status start_move(std::size_t, double position, double speed) override {
    bench_.asked_position = position;
    bench_.asked_speed = speed;
    return {};
  }
  Result<Position> read() override {
    Position out;
    out.axes = {bench_.position, 0};
    out.alarm = bench_.alarm;
    out.timestamp_ns = now_ns();
    return out;
  }
  Status set_laser(int, double power) override {
    bench_.laser = power;
    return {};
  }
  Status stop() override {
    ++bench_.stops;
    bench_.laser = 0;
    return {};
  }
  Status home(const Cancelled& cancelled) override {
    while (!bench_.finds_switch && !cancelled()) {
    }
    return bench_.finds_switch ? Status{} : fail(ErrorKind::kCancelled, "stopped while it was homed");
  }
  Status halt() override { return stop(); }
  [[nodiscard]] std::string panic() const override { return "!"; }

 private:
  Bench& bench_;
};

/// A line on which the other end says what it is made to say.
class BenchLink : public Link {
 public:
  Status write(std::string_view bytes) override {
    for (const char c : bytes) {
      asked_ += c;
      for (const auto& [question, answer] : answers) {
        if (asked_.ends_with(question)) {
          waiting_ += answer;
          asked_.clear();
        }
      }
    }
    return {};
  }
  Result<std::string> read(std::chrono::milliseconds /*timeout*/) override {
    return waiting_.empty() ? babble : std::exchange(waiting_, {});
  }
  std::vector<std::pair<std::string, std::string>> answers;
  std::string babble;  ///< what comes when nothing else does

 private:
  std::string asked_, waiting_;
};

Result<std::unique_ptr<Controller>> controller_of(Bench& bench) {
  return Controller::open(
      {.link = []() -> Result<std::unique_ptr<Link>> { return std::make_unique<BenchLink>(); },
       .firmware = [&bench](Link&) -> Result<std::unique_ptr<Firmware>> {
         return std::make_unique<BenchFirmware>(bench);
       },
       .guard = {},
       .homing = 50ms},
      "bench");
}

TEST(Controller, AnAlarmOnTheWayPutsTheLaserOff) {
  Bench bench;
  const auto controller = controller_of(bench).value();
  ASSERT_TRUE(controller->set_laser(0, 1));
  bench.alarm = true;
  const Status moved = controller->move(0, 10, 5, false);
  ASSERT_FALSE(moved);
  EXPECT_THAT(moved.error().line(), HasSubstr("went into alarm 10.000 mm short of its target"));
  EXPECT_EQ(bench.laser, 0);
  EXPECT_EQ(controller->read()->power[0], 0);
}

TEST(Controller, ASwitchThatIsNotFoundIsNoEndlessWait) {
  Bench bench;
  bench.finds_switch = false;
  const auto controller = controller_of(bench).value();
  const Status homed = controller->home();
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(homed.error().line(), HasSubstr("looked for its switch in vain"));
}

/// Where a switch is outside the soft limits the stage stands there after it is homed.
TEST(Controller, OutsideItsLimitsIsNoImpossiblePositionWithinItsReach) {
  Bench bench;
  const auto controller = controller_of(bench).value();
  const auto at_switch = controller->read();
  ASSERT_TRUE(at_switch) << at_switch.error().line();
  EXPECT_EQ(at_switch->position.axes[0], 0);
  EXPECT_FALSE(controller->move(0, 0, 0, true));  // but it is not sent there
  bench.position = -30;
  EXPECT_THAT(controller->read().error().line(), HasSubstr("impossible position"));
}

TEST(Controller, ASpeedThatNobodyNamesIsTheSameShareOfEachAxis) {
  Bench bench;
  const auto controller = controller_of(bench).value();
  ASSERT_TRUE(controller->move(0, 20, 0, true));
  EXPECT_EQ(bench.asked_speed, 25);
  const Status turned = controller->move(1, 0.5, 0, true);
  ASSERT_TRUE(turned) << turned.error().line();
  EXPECT_EQ(bench.asked_speed, 0.1);
  controller->set_speed(5);
  EXPECT_EQ(controller->speed(), 5);
  ASSERT_TRUE(controller->move(1, 0.5, 0, true));
  EXPECT_NEAR(bench.asked_speed, 0.02, 1e-12);
}

TEST(Controller, ALaserThatIsOnOrOffHasNoHalfPower) {
  Bench bench;
  const auto controller = controller_of(bench).value();
  EXPECT_THAT(controller->set_laser(0, 0.5).error().line(), HasSubstr("give 0 or 1"));
  EXPECT_EQ(bench.laser, 0);
  EXPECT_TRUE(controller->set_laser(0, 1));
}

constexpr const char* kBanner = "Grbl 1.1h ['$' for help]\r\n";

TEST(Controller, AnAxisWithoutWayOrSpeedIsRefused) {
  for (const char* settings : {"$110=0\r\nok\r\n", "$130=-200\r\nok\r\n", "$22=1\r\n$130=0\r\nok\r\n"}) {
    BenchLink link;
    link.answers = {{"\x18", kBanner}, {"$$\n", settings}};
    const Status connected = make_grbl(link, {AxisWish{}}, "bench")->connect();
    ASSERT_FALSE(connected) << settings;
    EXPECT_EQ(connected.error().kind, ErrorKind::kBadInput);
    EXPECT_THAT(connected.error().line(), HasSubstr("set its travel ($130) and its rate ($110)"));
  }
}

/// GRBL answers nothing while it looks for its switches, not even `?`.
TEST(Controller, AHomingThatIsMuteForLongIsWaitedFor) {
  BenchLink link;
  link.answers = {{"\x18", kBanner}, {"$$\n", "$22=1\r\n$110=3000\r\nok\r\n"}};
  const std::unique_ptr<Firmware> firmware = make_grbl(link, {AxisWish{}}, "bench");
  ASSERT_TRUE(firmware->connect());
  const Clock::time_point begun = Clock::now();
  const Status homed = firmware->home([&] {
    if (Clock::now() - begun > kAnswer + 300ms) {
      link.babble = "ok\r\n";
    }
    return false;
  });
  EXPECT_TRUE(homed) << homed.error().line();
  EXPECT_TRUE(firmware->homed());
  link.babble = kBanner;  // its power failed on the way
  EXPECT_THAT(firmware->home([] { return false; }).error().line(), HasSubstr("the controller restarted"));
  EXPECT_FALSE(firmware->homed());
}

TEST(Controller, GrblMayStandAtItsSwitchBeyondItsLimits) {
  BenchLink link;
  link.answers = {{"\x18", kBanner}, {"$$\n", "$22=1\r\n$110=3000\r\n$130=200\r\nok\r\n"}};
  const AxisWish wish{.name = "x", .rotary = false, .limits = {{-120, -50}}};
  const std::unique_ptr<Firmware> firmware = make_grbl(link, {wish}, "bench");
  ASSERT_TRUE(firmware->connect());
  const Axis& axis = firmware->axes().front();
  EXPECT_EQ(axis.minimum, -120);
  EXPECT_EQ(axis.maximum, -50);
  EXPECT_EQ(axis.reach, std::pair(-200.0, 200.0));  // its switch may be at either end
}

/// With $13=1 all positions of its reports are, that of the work offset too.
TEST(Controller, GrblMayReportInches) {
  for (const char* report : {"<Idle|MPos:-2.0000,0.0000,0.0000>\r\n",
                             "<Idle|WPos:-3.0000,0.0000,0.0000|WCO:1.0000,0.0000,0.0000>\r\n"}) {
    BenchLink link;
    link.answers = {
        {"\x18", kBanner}, {"$$\n", "$13=1\r\n$22=1\r\n$110=3000\r\n$130=200\r\nok\r\n"}, {"?", report}};
    const std::unique_ptr<Firmware> firmware = make_grbl(link, {AxisWish{}}, "bench");
    ASSERT_TRUE(firmware->connect());
    const Result<Position> now = firmware->read();
    ASSERT_TRUE(now) << now.error().line();
    EXPECT_NEAR(now->axes.front(), -50.8, 1e-9) << report;
  }
}

TEST(Controller, ATurntableKeepsTheLimitsThatItIsGiven) {
  BenchLink link;
  link.answers = {{"\x18\r\n", "Horus 0.2 ['$' for help]\r\n"},
                  {"M70T1\r\n", "ok\r\n"},
                  {"M70T2\r\n", "ok\r\n"},
                  {"M17\r\n", "ok\r\n"}};
  const std::unique_ptr<Firmware> firmware =
      make_horus(link, {AxisWish{.name = "x", .rotary = false, .limits = {{30, 180}}}}, "bench");
  const Status connected = firmware->connect();
  ASSERT_TRUE(connected) << connected.error().line();
  const Axis& axis = firmware->axes().front();
  EXPECT_NEAR(axis.minimum, rad_from_deg(30), 1e-12);
  EXPECT_NEAR(axis.maximum, rad_from_deg(180), 1e-12);
  EXPECT_EQ(axis.reach.first, 0);
  EXPECT_FALSE(axis.endless);
  EXPECT_EQ(make_horus(link, {AxisWish{}, AxisWish{}}, "bench")->connect().error().kind, ErrorKind::kUsage);
}

TEST(Controller, OneThatNeverStopsTalkingIsNoEndlessWait) {
  BenchLink link;
  link.answers = {
      {"\x18", kBanner}, {"$$\n", "$110=3000\r\nok\r\n"}, {"?", "<Idle|MPos:0.000,0.000,0.000>\r\n"}};
  link.babble = "[MSG:all is well]\r\n";
  const Status connected = make_grbl(link, {AxisWish{}}, "bench")->connect();
  EXPECT_TRUE(connected) << connected.error().line();
  // And one that is no controller at all, but has much to say.
  BenchLink other;
  other.babble = "21.5\r\n";
  EXPECT_THAT(make_by_banner(other, {AxisWish{}}, "bench").error().line(),
              HasSubstr("neither that it is GRBL"));
  other.answers = {{"\x18", "Gr"}};
  other.babble = "bl 1.1h\r\n";  // in two pieces
  EXPECT_TRUE(make_by_banner(other, {AxisWish{}}, "bench"));
}

TEST(Durations, AreNeverLongerThanTheClockHas) {
  EXPECT_EQ(duration_of(1.5), 1500ms);
  EXPECT_EQ(duration_of(-1), 0ms);
  EXPECT_EQ(duration_of(1e30), 24h);
  EXPECT_EQ(duration_of(std::numeric_limits<double>::infinity()), 24h);
}

}  // namespace
}  // namespace dubsar::usb_stage
