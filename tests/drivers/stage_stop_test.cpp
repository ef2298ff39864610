// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a stop says of a stage that obeys, of one that does not, and of one that is not there any more; and
// that nothing follows an emergency stop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/usb_stage/controller.h"

namespace dubsar::usb_stage {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

/// A board on the table, and what came over its line: C when it was connected, ! the bytes of an emergency
/// stop, H and S what makes sure of it and of a stop, M a move, L and D its laser.
struct Board {
  std::atomic<bool> reachable = true;  ///< its cable is in
  std::atomic<bool> answers = true;
  std::atomic<double> laser = 0;
  std::atomic<bool> moving = false;
  std::atomic<int> moves_asked = 0;
  std::function<void()> before_move;  ///< on the thread that asks for it
  std::function<Status()> read;       ///< before its answer

  Status hear(std::string_view bytes) {
    if (!reachable) {
      return fail(ErrorKind::kDevice, "the controller was unplugged or is not there", "bench",
                  "see to its cable");
    }
    const std::lock_guard lock(mutex_);
    heard_ += bytes;
    return {};
  }
  [[nodiscard]] std::string heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  /// Until that has come over the line.
  void wait_for(char what) {
    while (heard().find(what) == std::string::npos) {
      std::this_thread::sleep_for(1ms);
    }
  }

 private:
  std::mutex mutex_;
  std::string heard_;
};

class BoardLink : public Link {
 public:
  explicit BoardLink(Board& board) : board_(board) {}
  Status write(std::string_view bytes) override {
    const Status heard = board_.hear(bytes);
    if (heard && bytes == "!" && board_.answers) {
      rest();
    }
    return heard;
  }
  Result<std::string> read(std::chrono::milliseconds /*timeout*/) override { return ""; }

 private:
  void rest() {
    board_.laser = 0;
    board_.moving = false;
  }
  Board& board_;
};

class BoardFirmware : public Firmware {
 public:
  BoardFirmware(Board& board, Link& link) : board_(board), link_(link) {
    axes_ = {{"x", false, false, false, -100, 100, 50, 0.001, {-100, 100}}};
    homed_ = true;
  }
  Status connect() override { return rest("C"); }
  Status start_move(std::size_t, double, double) override {
    ++board_.moves_asked;
    if (board_.before_move) {
      board_.before_move();
    }
    const Status sent = said("M");
    board_.moving = board_.moving || sent;
    return sent;
  }
  Result<Position> read() override {
    if (const Status able = board_.read ? board_.read() : Status{}; !able) {
      return std::unexpected(able.error());
    }
    if (const Status asked = said("?"); !asked) {
      return std::unexpected(asked.error());
    }
    Position out;
    out.axes = {0};
    out.moving = board_.moving;
    out.timestamp_ns = now_ns();
    return out;
  }
  Status set_laser(int, double power) override {
    const Status sent = said(power > 0 ? "L" : "D");
    board_.laser = sent ? power : board_.laser.load();
    return sent;
  }
  [[nodiscard]] bool light_waits() const override { return false; }
  Status stop() override { return rest("S"); }
  Status home(const Cancelled&) override { return fail(ErrorKind::kUsage, "it has no switch"); }
  Status halt() override { return rest("H"); }
  [[nodiscard]] std::string panic() const override { return "!"; }

 private:
  Status said(std::string_view what) {
    const Status sent = link_.write(what);
    if (!sent || board_.answers) {
      return sent;
    }
    return fail(ErrorKind::kDevice, "the controller does not answer", "bench", "see to its power and cable");
  }
  Status rest(std::string_view how) {
    const Status sent = said(how);
    if (sent) {
      board_.laser = 0;
      board_.moving = false;
    }
    return sent;
  }
  Board& board_;
  Link& link_;
};

class StageStop : public testing::Test {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<Controller>> opened = Controller::open(
        {.link = [this]() -> Result<std::unique_ptr<Link>> {
           auto link = std::make_unique<BoardLink>(board_);
           const Status there = board_.hear("");
           return there ? Result<std::unique_ptr<Link>>(std::move(link)) : std::unexpected(there.error());
         },
         .firmware = [this](Link& link) -> Result<std::unique_ptr<Firmware>> {
           return std::make_unique<BoardFirmware>(board_, link);
         },
         .guard = {}},
        "bench");
    ASSERT_TRUE(opened) << opened.error().line();
    stage_ = std::move(*opened);
  }
  /// Of a stop and of an emergency stop: neither says that all is well.
  void expect_not_sure() {
    for (const Status& said : {stage_->stop(), stage_->emergency_stop(), stage_->stop()}) {
      ASSERT_FALSE(said);
      EXPECT_EQ(said.error().kind, ErrorKind::kDevice);
      EXPECT_THAT(said.error().line(), HasSubstr("its laser or its motor was on; pull the plugs of laser"));
    }
  }
  Board board_;
  std::unique_ptr<Controller> stage_;
};

TEST_F(StageStop, OfOneThatIsLostWithItsLaserOnSaysSoUntilItIsThereAgain) {
  ASSERT_TRUE(stage_->set_laser(0, 1));
  board_.reachable = false;
  const auto lost = stage_->read();
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().line(), HasSubstr("unplugged or is not there; pull the plugs of laser and stage"));
  expect_not_sure();
  EXPECT_THAT(stage_->read().error().line(), HasSubstr("pull the plugs of laser and stage"));
  board_.reachable = true;
  EXPECT_EQ(board_.laser, 1);
  ASSERT_TRUE(stage_->read());
  EXPECT_EQ(board_.laser, 0);
  EXPECT_TRUE(stage_->stop());
  EXPECT_TRUE(stage_->emergency_stop());
}

TEST_F(StageStop, OfOneThatIsLostInMotionSaysSo) {
  ASSERT_TRUE(stage_->move(0, 50, 1, true));
  board_.reachable = false;
  ASSERT_FALSE(stage_->read());
  expect_not_sure();
}

TEST_F(StageStop, OfOneThatWasDarkAndAtRestWhenItWasLostIsNoTrouble) {
  ASSERT_TRUE(stage_->set_laser(0, 1));
  ASSERT_TRUE(stage_->move(0, 50, 1, true));
  ASSERT_TRUE(stage_->stop());
  board_.reachable = false;
  const auto lost = stage_->read();
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().line(), Not(HasSubstr("pull the plugs")));
  EXPECT_TRUE(stage_->stop());
  EXPECT_TRUE(stage_->emergency_stop());
}

/// What its line takes its firmware need not obey.
TEST_F(StageStop, OfOneThatHearsAndDoesNotAnswerIsNotSure) {
  ASSERT_TRUE(stage_->set_laser(0, 1));
  board_.answers = false;
  const Status halted = stage_->emergency_stop();
  ASSERT_FALSE(halted);
  EXPECT_THAT(halted.error().line(), HasSubstr("does not answer"));
  EXPECT_EQ(board_.laser, 1);
  expect_not_sure();
}

TEST_F(StageStop, OfALaserThatWasAskedForAndNeverAnsweredIsNotSure) {
  board_.answers = false;
  ASSERT_FALSE(stage_->set_laser(0, 1));
  expect_not_sure();
}

/// A thread on its way to ask for a move, and others that come while the emergency stop waits for it.
TEST_F(StageStop, NothingIsAskedForBehindAnEmergencyStop) {
  std::promise<void> on_its_way;
  board_.before_move = [&] {
    on_its_way.set_value();
    board_.wait_for('!');
    std::this_thread::sleep_for(50ms);  // the others come to the door
  };
  std::vector<std::future<Status>> moves;
  const auto move = [&] { return stage_->move(0, 50, 1, true); };
  moves.push_back(std::async(std::launch::async, move));
  on_its_way.get_future().wait();
  std::future<Status> halt = std::async(std::launch::async, [&] { return stage_->emergency_stop(); });
  board_.wait_for('!');
  for (int k = 0; k < 4; ++k) {
    moves.push_back(std::async(std::launch::async, move));
    moves.push_back(std::async(std::launch::async, [&] { return stage_->set_laser(0, 1); }));
  }
  const Status halted = halt.get();
  EXPECT_TRUE(halted) << halted.error().line();
  for (std::future<Status>& one : moves) {
    EXPECT_FALSE(one.get());
  }
  EXPECT_EQ(board_.moves_asked, 1);
  EXPECT_EQ(board_.heard(), "C!H");
  EXPECT_FALSE(board_.moving);
}

/// Its own reset, that another thread reads as a failure, is not one.
TEST_F(StageStop, AReadThatSeesTheEmergencyStopsResetLosesNoController) {
  ASSERT_TRUE(stage_->set_laser(0, 1));
  std::promise<void> asks;
  board_.read = [&]() -> Status {
    asks.set_value();
    board_.wait_for('!');
    return fail(ErrorKind::kDevice, "the controller restarted", "bench");
  };
  std::future<bool> reads = std::async(std::launch::async, [&] { return stage_->read().has_value(); });
  asks.get_future().wait();
  const Status halted = stage_->emergency_stop();
  EXPECT_TRUE(halted) << halted.error().line();
  EXPECT_FALSE(reads.get());
  EXPECT_EQ(board_.laser, 0);
  EXPECT_EQ(board_.heard(), "CL!H");
  board_.read = {};
}

}  // namespace
}  // namespace dubsar::usb_stage
