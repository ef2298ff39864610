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
  double laser = 0;
  int stops = 0;
};

class BenchFirmware : public Firmware {
 public:
  explicit BenchFirmware(Bench& bench) : bench_(bench) {
    axes_ = {{"x", false, true, false, -100, 100, 50, 0.001}};
    homed_ = true;
  }
  Status connect() override { return {}; }
  Status start_move(std::size_t, double, double) override { return {}; }
  Result<Position> read() override {
    Position out;
    out.axes = {bench_.position};
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

TEST(Controller, OneThatNeverStopsTalkingIsNoEndlessWait) {
  BenchLink link;
  link.answers = {{"\x18", kBanner}, {"$$\n", "$110=3000\r\nok\r\n"}};
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
