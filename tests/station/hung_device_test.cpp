// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A device whose driver does not come back: the command that was stopped ends without it, and the session is
// whole and free. And one that comes back and could not be stopped.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include "build_paths.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using test::RunningCommand;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class HungDevice : public ::testing::Test {
 protected:
  [[nodiscard]] std::string in(const std::string& name) const { return (folder_.path() / name).string(); }
  /// It hangs for ever, after so many whole scans.
  [[nodiscard]] std::string device(int whole) const {
    return "hang:" + in("never") + "?whole=" + std::to_string(whole);
  }
  [[nodiscard]] static test::CommandOptions with_plugin() {
    return {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/hang"}};
  }
  /// By itself, in a way that the caller can tell; the driver was told before.
  static void expect_ended(const Outcome& ended) {
    EXPECT_FALSE(ended.timed_out);
    EXPECT_EQ(ended.signal, 0);
    EXPECT_EQ(ended.status, 3) << ended.err;
    const std::size_t told = ended.err.find("hang: told to stop");
    const std::size_t silent = ended.err.find("the device does not answer: stop the laser");
    const std::size_t ends = ended.err.find("the device does not answer: the program ends without it");
    EXPECT_LT(told, silent) << ended.err;
    EXPECT_LT(silent, ends) << ended.err;
    EXPECT_NE(ends, std::string::npos) << ended.err;
    EXPECT_THAT(ended.complaints(), SizeIs(2)) << ended.err;
  }
  test::TemporaryFolder folder_;
};

TEST_F(HungDevice, ALoginThatEndsEndsTheScanAndTheSessionIsWholeAndFree) {
  const std::string session = in("s");
  RunningCommand running({"scan", "--device", device(1), "--session", session, "--max-scans", "3", "--json"},
                         with_plugin());
  ASSERT_TRUE(running.says("scan 0 stored")) << running.log_until_now();
  ASSERT_TRUE(running.says("hang: hangs")) << running.log_until_now();
  running.send(SIGTERM);
  const Outcome ended = running.wait();
  expect_ended(ended);
  EXPECT_THAT(ended.json()["error"]["where"].get<std::string>(), HasSubstr("hang:"));

  const Outcome verified = run_command({"verify", session});
  EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  const Outcome described = run_command({"session", "describe", session, "--notes", "the scanner hung"});
  EXPECT_EQ(described.status, 0) << described.err;
  const nlohmann::json listed = run_command({"session", "list", session, "--json"}).json();
  ASSERT_THAT(listed["scans"], SizeIs(1));
  EXPECT_EQ(listed["scans"][0]["samples"], 12000);
  // The same command goes on with a scanner that is well again.
  std::ofstream(in("never")) << "released";
  const Outcome again =
      run_command({"scan", "--device", device(2), "--session", session, "--max-scans", "2"}, with_plugin());
  EXPECT_THAT(again.err, HasSubstr("scan 1 stored"));
  EXPECT_EQ(run_command({"verify", session}).status, 0);
}

TEST_F(HungDevice, AVerificationEndsLikewise) {
  std::ofstream(in("a.toml"))
      << "name = \"plane\"\ncertificate = \"c\"\nplane = true\n[limit]\nflatness_um = 60\n";
  RunningCommand running({"calibrate", "--verify", in("a.toml"), device(0)}, with_plugin());
  ASSERT_TRUE(running.says("hang: hangs")) << running.log_until_now();
  running.send(SIGINT);
  expect_ended(running.wait());
}

TEST_F(HungDevice, WhoeverInsistsWaitsForNothing) {
  RunningCommand running({"scan", "--device", device(0), "--session", in("s")}, with_plugin());
  ASSERT_TRUE(running.says("hang: hangs")) << running.log_until_now();
  running.send(SIGINT);
  ASSERT_TRUE(running.says("hang: told to stop")) << running.log_until_now();
  running.send(SIGINT);
  const Outcome ended = running.wait();
  EXPECT_FALSE(ended.timed_out);
  EXPECT_NE(ended.status, 0);
}

/// Nobody may be told that it stands, dark, when its driver could not make it.
TEST_F(HungDevice, OneThatCouldNotBeStoppedIsNotCalledStopped) {
  std::ofstream(in("a.toml"))
      << "name = \"plane\"\ncertificate = \"c\"\nplane = true\n[limit]\nflatness_um = 60\n";
  const std::string deaf = device(0) + "&deaf=1";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"scan", "--device", deaf, "--session", in("s"), "--json"},
        {"calibrate", "--verify", in("a.toml"), deaf, "--json"}}) {
    RunningCommand running(command, with_plugin());
    ASSERT_TRUE(running.says("hang: scans on")) << running.log_until_now();
    running.send(SIGINT);
    const Outcome ended = running.wait();
    EXPECT_FALSE(ended.timed_out);
    EXPECT_EQ(ended.status, 3) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("stopped, but laser and motors may still be on: the controller does not "
                                     "answer; pull the plugs of laser and stage, or switch off their power"));
    EXPECT_THAT(ended.json()["error"]["what"].get<std::string>(), HasSubstr("may still be on")) << ended.out;
  }
  EXPECT_EQ(run_command({"verify", in("s")}).status, 0);
}

}  // namespace
}  // namespace dubsar
