// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sessions that go on, Ctrl-C in the middle of a scan, and kill -9 at any moment.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <regex>

#include "core/random.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using test::RunningCommand;
using test::write_bumpy_scans;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kScans = 3;

class Interrupted : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    write_bumpy_scans(at("scans"), kScans);
    whole_ = run_command(words("scans", "whole", ""));
  }
  static void TearDownTestSuite() { delete folder_; }

  [[nodiscard]] static fs::path at(const std::string& name) { return folder_->path() / name; }
  [[nodiscard]] static test::Arguments words(const char* scans, const std::string& session,
                                             const std::string& rate) {
    return {"scan", "--device", "replay:" + at(scans).string() + rate, "--session", at(session).string()};
  }
  static void expect_whole(const std::string& session) {
    const Outcome verified = run_command({"verify", at(session).string()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  }
  [[nodiscard]] static std::vector<int> stored_in(const std::string& session) {
    std::vector<int> ids;
    const nlohmann::json listed = run_command({"session", "list", at(session).string(), "--json"}).json();
    for (const auto& scan : listed.value("scans", nlohmann::json::array())) {
      ids.push_back(scan["id"]);
    }
    return ids;
  }
  static void expect_as_uninterrupted(const std::string& session) {
    EXPECT_THAT(stored_in(session), SizeIs(kScans));
    for (const char* file : {"export/poses.json", "mesh/model.ply"}) {
      EXPECT_FALSE(bytes_of(at("whole") / file).empty());
      EXPECT_TRUE(bytes_of(at("whole") / file) == bytes_of(at(session) / file)) << session << " " << file;
    }
  }

  static test::TemporaryFolder* folder_;
  static Outcome whole_;
};
test::TemporaryFolder* Interrupted::folder_ = nullptr;
Outcome Interrupted::whole_;

TEST_F(Interrupted, AReplayRegistersWhatItReads) {
  EXPECT_EQ(whole_.status, 1) << whole_.err;  // a field seen from above has no reverse
  const auto poses = read_poses(at("whole") / "export" / "poses.json");
  ASSERT_TRUE(poses.has_value());
  ASSERT_THAT(*poses, SizeIs(kScans));
  for (const ScanPose& pose : *poses) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    const RigidTransform wrong = pose.model_from_scanner.inverse() * poses->front().model_from_scanner *
                                 test::bumpy_pose(0).inverse() * test::bumpy_pose(pose.id);
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(14, 0, 0), Eigen::Vector3d(-14, 14, 0)}) {
      EXPECT_LT((wrong * p - p).norm(), 0.1) << pose.file;
    }
  }
  expect_whole("whole");
}

TEST_F(Interrupted, TheSameReplayTwiceAddsNothing) {
  ASSERT_EQ(run_command(words("scans", "twice", "")).status, 1);
  const Outcome again = run_command(words("scans", "twice", ""));
  EXPECT_EQ(again.status, 1) << again.err;
  EXPECT_THAT(again.err, ::testing::Not(HasSubstr("stored")));
  expect_as_uninterrupted("twice");
}

TEST_F(Interrupted, ALimitCountsOnlyWhatIsNew) {
  auto limited = words("scans", "limited", "");
  limited.insert(limited.end(), {"--max-scans", "1"});
  run_command(limited);
  EXPECT_THAT(stored_in("limited"), SizeIs(1));
  limited.back() = "3";
  run_command(limited);
  expect_as_uninterrupted("limited");
}

TEST_F(Interrupted, CtrlCStopsInGoodOrder) {
  RunningCommand running(words("scans", "stopped", "?rate=100"));
  ASSERT_TRUE(running.says("scan 0 stored"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // in the middle of the second scan
  running.send(SIGINT);
  const Outcome stopped = running.wait();
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_EQ(stopped.signal, 0);
  EXPECT_THAT(stopped.complaints(), SizeIs(1)) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stopped; 1 scan is stored"));
  EXPECT_EQ(stopped.out, "");
  EXPECT_THAT(stored_in("stopped"), ::testing::ElementsAre(0));
  expect_whole("stopped");
  EXPECT_EQ(run_command(words("scans", "stopped", "")).status, 1);
  expect_as_uninterrupted("stopped");
  expect_whole("stopped");
}

// As a login, a service or a time limit does when it ends; of two that wait, the lower number comes first.
TEST_F(Interrupted, WhateverSystemsSendTogetherIsOneRequest) {
  RunningCommand running(words("scans", "ended", "?rate=100"));
  ASSERT_TRUE(running.says("scan 0 stored"));
  for (const int signal : {SIGHUP, SIGTERM, SIGTERM, SIGHUP}) {
    running.send(signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Outcome stopped = running.wait();
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_EQ(stopped.signal, 0);
  EXPECT_THAT(stopped.err, HasSubstr("stopped; 1 scan is stored"));
  expect_whole("ended");
}

TEST_F(Interrupted, WhatIsPlacedIsInTheSessionAtOnce) {
  RunningCommand running(words("scans", "poses", "?rate=100"));
  ASSERT_TRUE(running.says("scan 0 registered"));
  running.send(SIGKILL);
  running.wait();
  const nlohmann::json listed = run_command({"session", "list", at("poses").string(), "--json"}).json();
  ASSERT_FALSE(listed["scans"].empty());
  EXPECT_EQ(listed["scans"][0]["status"], "registered");
}

TEST_F(Interrupted, KilledAtAnyMomentKeepsWhatItSaidIsStored) {
  Random random(20);
  const std::regex said(R"(scan (\d+) stored)");
  for (int round = 0; round < 5; ++round) {
    const std::string session = "killed " + std::to_string(round);
    RunningCommand running(words("scans", session, "?rate=400"));
    const auto moment = std::chrono::milliseconds(static_cast<int>(random.uniform(40, 1200)));
    std::this_thread::sleep_for(moment);
    running.send(SIGKILL);
    const Outcome killed = running.wait();
    EXPECT_EQ(killed.signal, SIGKILL) << moment.count() << " ms";
    if (!fs::exists(at(session) / "session.sqlite")) {
      continue;
    }
    expect_whole(session);
    const std::vector<int> there = stored_in(session);
    for (std::sregex_iterator it(killed.err.begin(), killed.err.end(), said), end; it != end; ++it) {
      EXPECT_THAT(there, ::testing::Contains(std::stoi((*it)[1]))) << moment.count() << " ms" << killed.err;
    }
    EXPECT_EQ(run_command(words("scans", session, "")).status, 1);
    expect_as_uninterrupted(session);
  }
}

// Nobody scans the same side once more because the power went.
TEST_F(Interrupted, KilledInMidScanKeepsTheRowsUntilThen) {
  const fs::path session = at("half");
  RunningCommand running({"scan", "--device", "sim:?seed=4&size=100x80x20&spacing=0.03&mesh_spacing=1",
                          "--session", session.string()});
  const fs::path rows = session / "grids" / "unfinished" / "1" / "0000.grid";
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!fs::exists(rows) && std::chrono::steady_clock::now() < patience) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  running.send(SIGKILL);
  ASSERT_EQ(running.wait().signal, SIGKILL);
  ASSERT_TRUE(fs::exists(rows));
  EXPECT_THAT(stored_in("half"), SizeIs(0));
  expect_whole("half");
  // Whatever scans here next takes it up, once.
  const Outcome next = run_command(words("scans", "half", ""));
  EXPECT_THAT(next.err, HasSubstr("a scan in whose middle the program ended is kept: "));
  EXPECT_FALSE(fs::exists(session / "grids" / "unfinished"));
  const nlohmann::json listed = run_command({"session", "list", session.string(), "--json"}).json();
  ASSERT_THAT(listed["scans"], SizeIs(kScans + 1));
  EXPECT_GT(listed["scans"][0]["samples"], 1000);
  EXPECT_THAT(run_command(words("scans", "half", "")).err, ::testing::Not(HasSubstr("is kept")));
  expect_whole("half");
}

}  // namespace
}  // namespace dubsar
