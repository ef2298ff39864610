// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// `scan --auto` with a tablet that people turn: nothing moves, and no laser goes on, before their word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "build_paths.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/station/support/typed_input.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using test::RunningCommand;
using test::TypedInput;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kOptions = "?seed=1&size=12x10x8&spacing=0.4&noise=0.02";
constexpr const char* kAsked = "Enter: it lies so";
constexpr const char* kTurned = "hands: moves, the tablet was turned";
constexpr const char* kUndrivenAsked = "Enter: the tablet lies as";

int times(const std::string& text, const std::string& what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
    ++count;
  }
  return count;
}

class HandTurns : public ::testing::Test {
 protected:
  [[nodiscard]] test::Arguments with(const std::string& device) const {
    return {"scan", "--auto", "--device", device, "--session", session_};
  }
  [[nodiscard]] static test::CommandOptions with_plugin(const std::string& name) {
    return {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/" + name}};
  }
  [[nodiscard]] std::size_t scans() const {
    return run_command({"session", "list", session_, "--json"}).json()["scans"].size();
  }
  /// What was said by the time that `what` was said so often; what there is where that does not come.
  static std::string log_with(RunningCommand& running, const std::string& what, int often) {
    std::string log = running.log_until_now();
    for (int k = 0; k < 24000 && times(log, what) < often; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      log = running.log_until_now();
    }
    return log;
  }
  test::TemporaryFolder folder_;
  std::string session_ = (folder_.path() / "s").string();
  std::string driven_ = std::string("hands:") + kOptions;
};

TEST_F(HandTurns, NothingMovesBeforeTheWord) {
  const TypedInput input(TypedInput::Kind::kTerminal);
  RunningCommand running(with(driven_), with_plugin("hands"));
  ASSERT_TRUE(running.says(kAsked)) << running.log_until_now();
  const std::string asked = running.log_until_now();
  EXPECT_THAT(asked, HasSubstr("next, by hand: "));
  ASSERT_TRUE(input.type("yes\n"));
  ASSERT_TRUE(running.says("Enter or q")) << running.log_until_now();
  const std::string still = running.log_until_now();
  EXPECT_EQ(times(still, kTurned), 0) << still;
  EXPECT_EQ(times(still, "hands: "), times(asked, "hands: ")) << still;
  ASSERT_TRUE(input.type("\n"));
  EXPECT_THAT(log_with(running, kAsked, 2), HasSubstr(kTurned));
  ASSERT_TRUE(input.type("q\n"));
  const Outcome ended = running.wait();
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_EQ(times(ended.err, kTurned), 1) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("not conclusive"));
}

TEST_F(HandTurns, WordByWordItComesToItsEnd) {
  const TypedInput input(TypedInput::Kind::kTerminal);
  RunningCommand running(with(driven_), with_plugin("hands"));
  std::jthread hasty([&](const std::stop_token& stop) {  // what is typed before the question is no answer
    while (!stop.stop_requested() && input.type("\n")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  const Outcome ended = running.wait();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_GT(times(ended.err, kTurned), 0) << ended.err;
  EXPECT_EQ(times(ended.err, kTurned), times(ended.err, kAsked)) << ended.err;
}

TEST_F(HandTurns, WithoutATerminalTheRunEndsAndTheSameCommandGoesOn) {
  const TypedInput input(TypedInput::Kind::kNone);
  std::size_t before = 0;
  for (int run = 0; run < 2; ++run) {
    const Outcome ended = run_command(with(driven_), with_plugin("hands"));
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_THAT(ended.err,
                HasSubstr("the tablet is to be turned by hand, and there is no terminal to ask at"));
    EXPECT_THAT(ended.err, HasSubstr(", then give the same command again, at a terminal"));
    EXPECT_THAT(ended.err, Not(HasSubstr(kTurned)));
    EXPECT_GT(scans(), before);
    before = scans();
  }
  const Outcome verified = run_command({"verify", session_});
  EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
}

TEST_F(HandTurns, CtrlCInsteadOfTheWordStops) {
  const TypedInput input(TypedInput::Kind::kTerminal);
  RunningCommand running(with(driven_), with_plugin("hands"));
  ASSERT_TRUE(running.says(kAsked)) << running.log_until_now();
  running.send(SIGINT);
  const Outcome ended = running.wait();
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("stopped; "));
  EXPECT_THAT(ended.err, Not(HasSubstr(kTurned)));
}

TEST_F(HandTurns, ASimulatedDeviceTurnsItsOwnTablet) {
  const TypedInput input(TypedInput::Kind::kNone);
  const Outcome ended = run_command(with(std::string("sim:") + kOptions));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("next: turn "));
  EXPECT_THAT(ended.err, Not(HasSubstr("by hand")));
}

TEST_F(HandTurns, AScannerWithoutMotorsWaitsBetweenItsScans) {
  const std::string device = "endless:" + test::write_bumpy_scans(folder_.path() / "scans", 3).string();
  {
    const TypedInput input(TypedInput::Kind::kTerminal);
    RunningCommand running(with(device), with_plugin("endless"));
    ASSERT_TRUE(running.says(kUndrivenAsked)) << running.log_until_now();
    ASSERT_TRUE(running.says("\nnext: ")) << running.log_until_now();
    ASSERT_TRUE(input.type("yes\n"));
    ASSERT_TRUE(running.says("Enter or q")) << running.log_until_now();
    EXPECT_THAT(running.log_until_now(), Not(HasSubstr("scan 1 stored")));
    ASSERT_TRUE(input.type("\n"));
    EXPECT_EQ(times(log_with(running, kUndrivenAsked, 2), kUndrivenAsked), 2);
    ASSERT_TRUE(input.type("q\n"));
    EXPECT_EQ(running.wait().status, 1);
    EXPECT_EQ(scans(), 2U);
  }
  const TypedInput none(TypedInput::Kind::kNone);
  auto limited = with(device);
  limited.insert(limited.end(), {"--max-scans", "9"});
  const Outcome ended = run_command(limited, with_plugin("endless"));
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("  next "));
  EXPECT_EQ(scans(), 3U);
}

}  // namespace
}  // namespace dubsar
