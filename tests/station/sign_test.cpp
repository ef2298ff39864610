// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The checklist of a session that falls short: what may be signed, and what plan and its files say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/session_store.h"
#include "core/pin_set.h"
#include "formats/pins_json.h"
#include "station/not_conclusive.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// One side of a bumpy field: its other side has never been seen. Scanned once; each test has a copy.
class HalfScanned : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder;
    const fs::path scans = test::write_bumpy_scans(made_->path() / "scans", 3);
    scanned_ = run_command({"scan", "--device", "replay:" + scans.string(), "--session",
                            (made_->path() / "session").string(), "--json"});
  }
  static void TearDownTestSuite() { delete made_; }
  void SetUp() override {
    ASSERT_EQ(scanned_.status, 1) << scanned_.err;
    ASSERT_EQ(scanned_.json()["conclusive"], false);
    fs::copy(made_->path(), folder_.path(), fs::copy_options::recursive);
    session_ = (folder_.path() / "session").string();
  }
  [[nodiscard]] Outcome sign(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"session", "sign", session_, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  static test::TemporaryFolder* made_;
  static Outcome scanned_;
  test::TemporaryFolder folder_;
  std::string session_;
};
test::TemporaryFolder* HalfScanned::made_ = nullptr;
Outcome HalfScanned::scanned_;

TEST(NotConclusive, SaysHowMuchIsRedButNeverThatNothingIs) {
  EXPECT_EQ(not_conclusive(12.34), "not conclusive: about 12.3 mm2 are still red");
  EXPECT_EQ(not_conclusive(0.03), "not conclusive: less than 0.1 mm2 are still red");
  EXPECT_EQ(not_conclusive(0), "not conclusive: no scan is registered, nothing is known of the clay");
  EXPECT_EQ(out_of_reach(1900.04),
            "; about 1900.0 mm2 are out of reach and not recorded: the checklist says why");
  EXPECT_EQ(out_of_reach(0.01), "");
}

TEST_F(HalfScanned, IsSignedAsIncompleteOnlyAndWithTheReason) {
  const Outcome refused = sign({"--name", "A. Reader"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
  EXPECT_THAT(refused.json()["error"]["what"].get<std::string>(), HasSubstr("not conclusive"));
  EXPECT_EQ(run_command({"session", "list", session_, "--json"}).json()["sign_offs"].size(), 0U);

  EXPECT_EQ(sign({}).status, 2) << "nobody signed";
  EXPECT_EQ(sign({"--name", "  "}).status, 2);
  EXPECT_EQ(sign({"--name", "A", "--incomplete", ""}).status, 2);

  const Outcome made = sign({"--name", "A. Reader", "--incomplete", "the back is in plaster", "--note", "n"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.json()["sign_off"]["conclusive"], false);
  EXPECT_EQ(made.json()["sign_off"]["incomplete"], "the back is in plaster");
  EXPECT_THAT(bytes_of(made.json()["checklist"].get<std::string>()), HasSubstr("the back is in plaster"));
  EXPECT_EQ(run_command({"verify", session_}).status, 0);

  const Outcome again = sign({"--name", "B. Reader", "--incomplete", "still"});
  EXPECT_EQ(again.json()["sign_off"]["number"], 2);
  const auto list = run_command({"session", "list", session_, "--json"}).json()["sign_offs"];
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0]["name"], "A. Reader");
  EXPECT_EQ(list[0]["holds"], true) << "a second signature changes nothing of what the first one stands for";
}

TEST_F(HalfScanned, WhatIsWrongWithAScanInTheModelIsToldBeforeAndWithTheSignature) {
  const std::string wrong = "against the other scans it is 2 % too large: its calibration is not theirs";
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    ASSERT_EQ(poses.at(1).status, PoseStatus::kRegistered);
    poses[1].warning = wrong;
    ASSERT_TRUE(store.save_poses(poses));
  }
  EXPECT_THAT(run_command({"plan", session_}).err, HasSubstr("scan 1: " + wrong));
  const Outcome made = sign({"--name", "A. Reader", "--incomplete", "the back is in plaster"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("scan 1: " + wrong));
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    poses[1].warning.clear();
    ASSERT_TRUE(store.save_poses(poses));
  }
  const Outcome void_now = run_command({"verify", session_});
  EXPECT_EQ(void_now.status, 1);
  EXPECT_THAT(void_now.out + void_now.err, HasSubstr("the warning of scan 1 is no longer part of it"));
}

TEST_F(HalfScanned, PlanSaysTheSameAndWritesPageAndStates) {
  const fs::path page = folder_.path() / "page.html";
  const fs::path states = folder_.path() / "states";
  const Outcome plan =
      run_command({"plan", session_, "--json", "--page", page.string(), "--states", states.string()});
  EXPECT_EQ(plan.status, 1) << plan.err;
  const nlohmann::json json = plan.json();
  EXPECT_EQ(json["stored"]["same"], true) << json["stored"];
  EXPECT_EQ(json["checklist"]["scans_registered"], 3);
  EXPECT_EQ(json["checklist"]["sign_off"], nullptr);
  EXPECT_EQ(json["checklist"]["store_whole"], true);
  EXPECT_THAT(bytes_of(page), HasSubstr("<h2>Not conclusive</h2>"));
  EXPECT_THAT(bytes_of(page), HasSubstr("last verification: not told"));
  EXPECT_EQ(run_command({"plan", session_, "--json"}).out, plan.out) << "the same session, the same bytes";
  // Each state file counts what the red map counts.
  for (const auto& scan : json["scans"]) {
    const std::string ply = bytes_of(states / ("states_00" + std::to_string(scan["id"].get<int>()) + ".ply"));
    const std::string head = ply.substr(0, ply.find("end_header"));
    EXPECT_THAT(head, HasSubstr("element vertex " + std::to_string(scan["samples"].get<long>()) + "\n"));
    EXPECT_THAT(head, HasSubstr(" red " + std::to_string(scan["sparse"].get<long>()) + "\n"));
    EXPECT_THAT(head, HasSubstr(" cleared " + std::to_string(scan["cleared"].get<long>()) + "\n"));
  }
}

TEST_F(HalfScanned, StatesOfAScanThatWasTakenOutAreTakenAway) {
  const fs::path states = folder_.path() / "states";
  const auto plan = [&] { return run_command({"plan", session_, "--states", states.string()}); };
  ASSERT_EQ(plan().status, 1);
  ASSERT_TRUE(fs::exists(states / "states_002.ply"));
  std::ofstream(states / "states_of_mine.ply") << "ply\n";
  ASSERT_EQ(run_command({"session", "drop", session_, "2"}).status, 0);
  EXPECT_EQ(plan().status, 1);
  EXPECT_TRUE(fs::exists(states / "states_001.ply"));
  EXPECT_FALSE(fs::exists(states / "states_002.ply"));
  EXPECT_TRUE(fs::exists(states / "states_of_mine.ply"));
}

TEST_F(HalfScanned, PosesOfAFileJudgeAloneAndLeaveTheSessionsVerdict) {
  const std::string poses = (fs::path(session_) / "export" / "poses.json").string();
  nlohmann::json moved = nlohmann::json::parse(bytes_of(poses));
  moved["scans"][1]["model_from_scanner"][3] = moved["scans"][1]["model_from_scanner"][3].get<double>() + 3;
  const fs::path file = folder_.path() / "moved.json";
  std::ofstream(file) << moved;
  const Outcome judged = run_command({"plan", session_, "--json", "--poses", file.string()});
  EXPECT_EQ(judged.status, 1) << judged.err;
  EXPECT_FALSE(judged.json().contains("stored"));
  EXPECT_EQ(run_command({"plan", session_, "--json"}).json()["stored"]["same"], true);
}

TEST_F(HalfScanned, AStaleRedMapIsNamedAndMadeAnew) {
  ASSERT_EQ(run_command({"session", "drop", session_, "2"}).status, 0);
  ASSERT_EQ(run_command({"register", session_}).status, 0);
  const Outcome refused = sign({"--name", "A", "--incomplete", "why"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.json()["error"]["mend"].get<std::string>(), HasSubstr("dubsar plan"));
  const Outcome plan = run_command({"plan", session_, "--json"});
  EXPECT_EQ(plan.json()["stored"]["same"], false);
  EXPECT_THAT(plan.json()["stored"]["differs"].dump(), HasSubstr("the scans: stored 3, now 2"));
  EXPECT_EQ(plan.json()["checklist"]["scans_registered"], 2);
  EXPECT_EQ(run_command({"plan", session_, "--json"}).json()["stored"]["same"], true);
  EXPECT_EQ(sign({"--name", "A", "--incomplete", "why"}).status, 0);
}

/// What was said of a scan and is not followed yet: nothing is signed over it.
class SaidSince : public HalfScanned {
 protected:
  void say(const std::vector<std::string>& words) const {
    std::vector<std::string> all{"session", words.front(), session_};
    all.insert(all.end(), words.begin() + 1, words.end());
    ASSERT_EQ(run_command(all).status, 0) << words.front();
  }
  void plan() const { run_command({"plan", session_}); }
  void is_refused(const std::string& why) const {
    const std::string what = "the poses do not follow yet what was said: " + why;
    const Outcome planned = run_command({"plan", session_});
    EXPECT_THAT(planned.complaints(), ::testing::Contains(HasSubstr(what + "; run dubsar register on it")));
    const Outcome refused = sign({"--name", "A", "--incomplete", "why"});
    EXPECT_EQ(refused.status, 1) << why;
    EXPECT_EQ(refused.json()["error"]["what"], what);
    EXPECT_THAT(refused.json()["error"]["mend"].get<std::string>(), HasSubstr("dubsar register"));
  }
  void is_signed() const {
    plan();
    EXPECT_EQ(sign({"--name", "A", "--incomplete", "why"}).status, 0);
  }
  const std::string elsewhere_ = "0 -1 0 1 1 0 0 2 0 0 1 0 0 0 0 1";
};

TEST_F(SaidSince, AHintOrAScanTakenOutIsFollowedFirst) {
  say({"hint", "2", "--on", "0", "--pose", elsewhere_});
  is_refused("scan 2 has been given a hint");
  run_command({"register", session_, "--only", "1"});
  is_refused("scan 2 has been given a hint");
  run_command({"register", session_});
  is_signed();
  say({"hint", "2", "--withdraw"});
  is_refused("the hint for scan 2 has been withdrawn");
  run_command({"register", session_, "--only", "2"});
  is_signed();
  say({"drop", "1"});
  is_refused("scan 1 has been taken out");
  run_command({"register", session_});
  is_signed();
  say({"restore", "1"});
  EXPECT_EQ(sign({"--name", "A", "--incomplete", "why"}).status, 1) << "it was never judged";
  plan();
  is_signed();
  say({"lock", "1"});
  say({"undo"});
  is_refused("scan 1 has been locked, scan 2 has been taken out");
  // What is taken back leaves nothing to follow.
  say({"unlock", "1"});
  say({"restore", "2"});
  is_signed();
}

/// As a window keeps them that is closed before they are heeded.
TEST_F(SaidSince, LabelsOfPinsAreFollowedFirst) {
  const auto label = [&](const std::vector<PinTip>& tips) {
    SessionStore store = SessionStore::open(session_).value();
    PinSet said;
    said.tip_diameter_mm = 1.5;
    said.tips[1] = tips;
    ASSERT_TRUE(store.append_event("pins labelled", pins_to_json(said)));
    if (tips.empty()) {
      said.tips.clear();
    }
    ASSERT_TRUE(store.save_document("pin_labels", pins_to_json(said)));
  };
  label({{7, {3, 4, 5}}});
  is_refused("the pins of scan 1 are labelled");
  label({});  // what is taken back leaves nothing to follow
  is_signed();
  label({{7, {3, 4, 5}}});
  run_command({"register", session_});
  label({});
  is_refused("the pins of scan 1 have no labels by hand any more");
  run_command({"register", session_});
  is_signed();
}

TEST_F(SaidSince, TheEngineFollowsByItself) {
  say({"drop", "1"});
  say({"hint", "2", "--on", "0", "--pose", elsewhere_});
  const std::string scans = (folder_.path() / "scans").string();
  run_command({"scan", "--device", "replay:" + scans, "--session", session_});
  is_signed();
}

TEST_F(SaidSince, InASessionOfAnEarlierVersionThePosesTell) {
  session_ = (folder_.path() / "earlier").string();
  const auto keep = [&](const ScanPose& last, bool is_1_locked) {
    SessionStore store = SessionStore::open_or_create(session_).value();
    std::vector<ScanPose> poses(2);
    for (int k = 0; k < 2; ++k) {
      ScanPose& pose = poses.at(static_cast<std::size_t>(k));
      pose.id = k;
      pose.model_from_scanner = test::bumpy_pose(k);
      pose.status = PoseStatus::kRegistered;
      pose.locked = k == 1 && is_1_locked;
    }
    poses.push_back(last);
    EXPECT_TRUE(store.save_poses(poses));
  };
  ScanPose last;
  last.id = 2;
  last.model_from_scanner = test::bumpy_pose(2);
  last.status = PoseStatus::kRegistered;
  {
    SessionStore store = SessionStore::open_or_create(session_).value();
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(store.add_grid(test::bumpy_scan(k)));
    }
  }
  keep(last, false);
  is_signed();
  say({"drop", "1"});
  is_refused("scan 1 has been taken out");
  say({"restore", "1"});
  is_signed();
  say({"lock", "1"});
  is_refused("scan 1 has been locked");
  keep(last, true);
  is_signed();
  say({"unlock", "1"});
  is_refused("scan 1 has been unlocked");
  keep(last, false);
  is_signed();
  say({"hint", "2", "--on", "0", "--pose", elsewhere_});
  is_refused("scan 2 has been given a hint");
  last.status = PoseStatus::kUnsure;
  last.reason = "the hint leads to no certain pose: its surface is too even";
  keep(last, false);
  is_signed();
}

TEST_F(HalfScanned, PlanKeepsThePosesOfScansThatWereNeverJudged) {
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    poses.pop_back();  // as a run that was stopped leaves them
    ASSERT_TRUE(store.save_poses(poses));
  }
  EXPECT_EQ(sign({"--name", "A", "--incomplete", "why"}).status, 1);
  const Outcome plan = run_command({"plan", session_, "--json"});
  EXPECT_EQ(plan.json()["checklist"]["scans_registered"], 3) << plan.err;
  EXPECT_EQ(SessionStore::open(session_, SessionStore::Access::kReadOnly).value().poses()->size(), 3U);
  EXPECT_EQ(run_command({"plan", session_, "--json"}).json()["stored"]["same"], true);
  const Outcome made = sign({"--name", "A", "--incomplete", "why"});
  EXPECT_EQ(made.status, 0) << made.err;
}

TEST_F(HalfScanned, EqualCountsAreNoDifference) {
  {
    Result<SessionStore> store = SessionStore::open(session_);
    ASSERT_TRUE(store);
    const auto text = store->load_document("red_map");
    ASSERT_TRUE(text && *text);
    nlohmann::ordered_json map = nlohmann::ordered_json::parse(**text);
    ASSERT_FALSE(map["regions"].empty());
    map["regions"][0]["area_mm2"] = map["regions"][0]["area_mm2"].get<double>() + 1;
    ASSERT_TRUE(store->save_document("red_map", map.dump()));
  }
  const Outcome refused = sign({"--name", "A", "--incomplete", "why"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.json()["error"]["what"].get<std::string>(),
              HasSubstr("scans and poses give: the places or sizes of the regions"));
}

TEST(Sign, NeedsASession) {
  const test::TemporaryFolder folder;
  const Outcome refused = run_command({"session", "sign", folder.path().string(), "--name", "A"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
}

}  // namespace
}  // namespace dubsar
