// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A motorised scan on a bad day: devices that stop, motors that fail, limits that leave nothing, and scans of
// nothing, of a hand, of another tablet. Each is named in a line, and the session stays whole.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class BadDay : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] test::Arguments words(const std::string& options, const std::string& session) const {
    return {"scan",
            "--auto",
            "--json",
            "--device",
            "sim:?seed=2&size=24x20x10&spacing=0.3" + (options.empty() ? "" : "&" + options),
            "--session",
            at(session).string()};
  }
  [[nodiscard]] Outcome scan(const std::string& options, const std::string& session = "session",
                             const test::Arguments& more = {}) const {
    test::Arguments arguments = words(options, session);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  [[nodiscard]] fs::path rig_file(const std::string& text) const {
    std::ofstream(at("rig.json")) << text;
    return at("rig.json");
  }
  void expect_whole(const std::string& session = "session") const {
    const Outcome verified = run_command({"verify", at(session).string()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  }
  [[nodiscard]] nlohmann::json listed(const std::string& session = "session") const {
    return run_command({"session", "list", at(session).string(), "--json"}).json()["scans"];
  }
  /// Red and cleared surface lies within the tablet's own size.
  static void expect_nothing_but_the_tablet(const nlohmann::json& red_map) {
    for (const auto& region : red_map["regions"]) {
      double r2 = 0;
      for (const double x : region["center"]) {
        r2 += x * x;
      }
      EXPECT_LT(r2, 22.0 * 22.0) << region.dump();
    }
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(BadDay, AnArmScansUntilItIsConclusive) {
  const Outcome outcome = scan("motion=robot");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("arm to the side of"));
  expect_whole();
  // The arm's poses are in the session: the next run plans on with them.
  const Outcome again = scan("motion=robot");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.json()["scans"], outcome.json()["scans"]);
}

TEST_F(BadDay, AHalfScanIsKeptRegisteredAndUseful) {
  const Outcome stopped = scan("stop_at=1&stop_rows=45");
  EXPECT_EQ(stopped.status, 3) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("the scanner stopped in the middle of the scan"));
  EXPECT_THAT(stopped.err, HasSubstr("the half scan is kept, rows: 45"));
  expect_whole();
  const nlohmann::json json = stopped.json();
  ASSERT_EQ(json["scans"], 2) << stopped.out;
  EXPECT_THAT(listed(), SizeIs(2));
  const auto& half = json["red_map"]["scans"].back();
  EXPECT_EQ(half["id"], 1) << "it takes part in the red map";
  EXPECT_GT(half["samples"].get<int>(), 500);
  EXPECT_GT(half["cleared"].get<int>(), 0);
  for (const auto& pose : json["poses"]["scans"]) {
    EXPECT_EQ(pose["status"], "registered") << pose.dump();
  }
  const Outcome gone_on = scan("");
  EXPECT_EQ(gone_on.status, 0) << gone_on.err;
  EXPECT_GT(gone_on.json()["scans"], 2);
  expect_whole();
}

TEST_F(BadDay, AFailedMoveEndsAllMotion) {
  const Outcome failed = scan("fail_move_at=1");
  EXPECT_EQ(failed.status, 3) << failed.err;
  EXPECT_THAT(failed.complaints(), SizeIs(1)) << failed.err;
  EXPECT_THAT(failed.err, HasSubstr("sim-2: a motor does not answer, half way there; see what holds it up"));
  EXPECT_EQ(failed.json()["scans"], 2);
  expect_whole();
  const Outcome gone_on = scan("", "session", {"--max-scans", "3"});
  EXPECT_EQ(gone_on.status, 1) << gone_on.err;
  EXPECT_EQ(gone_on.json()["scans"], 3);
  EXPECT_THAT(gone_on.err, HasSubstr("3 scans are there, as many as were to be taken; --max-scans"));
}

TEST_F(BadDay, CtrlCStopsAMove) {
  test::RunningCommand running(words("move_time=500", "session"));
  ASSERT_TRUE(running.says("next:"));
  running.send(SIGINT);
  const Outcome stopped = running.wait();
  EXPECT_FALSE(stopped.timed_out) << stopped.err;
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_THAT(stopped.complaints(), SizeIs(1)) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stopped; 1 scan is stored"));
  expect_whole();
}

TEST_F(BadDay, LimitsOfARigFileHold) {
  const fs::path file = rig_file(R"({"tilt_deg": [20, 45], "turntable_deg": [0, 180], "hand_turns": false})");
  const Outcome outcome = scan("", "session", {"--rig", file.string(), "--max-scans", "4"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.err, Not(HasSubstr("next: turn the")));
  const auto store = SessionStore::open(at("session"), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store);
  const auto text = store->load_document("drives");
  ASSERT_TRUE(text && *text);
  const nlohmann::json drives = nlohmann::json::parse(**text);
  ASSERT_GE(drives["scans"].size(), 2U);
  for (const auto& drive : drives["scans"]) {
    const double tilt = drive["tilt_rad"].get<double>() * 180 / 3.14159265358979;
    EXPECT_GE(tilt, 20 - 1e-6);
    EXPECT_LE(tilt, 45 + 1e-6);
    EXPECT_LE(drive["turntable_rad"].get<double>(), 3.1415927);
  }
}

TEST_F(BadDay, LimitsThatExcludeEveryViewAreSaidBeforeScanning) {
  for (const auto& [options, text, says] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"", R"({"tilt_deg": [80, 90]})", "the limits exclude every view: tilt 80.00 to 90.00 deg"},
           {"motion=robot", R"({"arm": {"reach": [5000, 6000]}})",
            "the limits exclude every view: the arm's reach"},
           {"motion=robot", R"({"arm": {"height": [0, 20]}})", "the limits exclude every view"},
           {"", R"({"keep_out_margin": 900})",
            "the limits exclude every view: the scanner's head would come"},
           {"", R"({"tilts_deg": [0, 10]})", "has 'tilts_deg'"}}) {
    const Outcome outcome = scan(options, "session", {"--rig", rig_file(text).string()});
    EXPECT_EQ(outcome.status, 2) << text << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << text;
    EXPECT_THAT(outcome.err, HasSubstr("rig.json")) << text;
    EXPECT_FALSE(fs::exists(at("session"))) << text;
  }
  EXPECT_EQ(scan("", "session", {"--rig", at("nowhere.json").string()}).status, 2);
  EXPECT_EQ(scan("", "session", {"--size", "24x20"}).status, 2);
}

TEST_F(BadDay, NothingBeforeTheScannerIsAskedForOnceMore) {
  const Outcome once = scan("intrude=gone@1", "once", {"--max-scans", "2"});
  EXPECT_EQ(once.status, 1) << once.err;
  EXPECT_THAT(once.err, HasSubstr("no sample at all: nothing stands before the scanner; the same view"));
  const Outcome twice = scan("intrude=gone@1-9", "twice");
  EXPECT_EQ(twice.status, 2) << twice.err;
  EXPECT_THAT(twice.complaints(), SizeIs(2)) << twice.err;
  EXPECT_EQ(twice.json()["scans"], 1);
  expect_whole("twice");
  const Outcome at_first = scan("intrude=gone@0-9", "never");
  EXPECT_EQ(at_first.status, 2) << at_first.err;
  EXPECT_TRUE(at_first.json().contains("error")) << at_first.out;
  expect_whole("never");
}

TEST_F(BadDay, AHandIsSetAsideInWords) {
  for (const std::string intruder : {"hand@2", "hand@0", "glove@2"}) {
    const Outcome outcome = scan("intrude=" + intruder, intruder, {"--max-scans", "5"});
    EXPECT_EQ(outcome.status, 1) << intruder << outcome.err;
    const std::string scan_id = intruder.substr(intruder.find('@') + 1);
    EXPECT_THAT(outcome.err, HasSubstr("something was in the way of scan " + scan_id + ":")) << intruder;
    expect_nothing_but_the_tablet(outcome.json()["red_map"]);
    for (const auto& one : listed(intruder)) {
      EXPECT_EQ(one["status"] == "dropped", one["id"] == std::stoi(scan_id)) << one.dump();
    }
    expect_whole(intruder);
  }
}

TEST_F(BadDay, AHandThatStaysEndsTheRun) {
  const Outcome outcome = scan("intrude=hand@1-30");
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("in a row are not taken up"));
  EXPECT_LT(outcome.json()["scans"].get<int>(), 10) << outcome.err;
  expect_whole();
}

TEST_F(BadDay, AnotherTabletIsNotTakenForTheFirst) {
  const Outcome outcome = scan("swap_at=1");
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("scan 1 is not taken up"));
  EXPECT_THAT(outcome.err, HasSubstr("another tablet lies there now; take the wrong ones out"));
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["scans"], 3) << outcome.err;
  EXPECT_NE(json["poses"]["scans"][0]["status"], json["poses"]["scans"][1]["status"]);
  expect_whole();
}

}  // namespace
}  // namespace dubsar
