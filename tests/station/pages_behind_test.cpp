// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// No page of a session goes on saying what is no longer so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "acquisition/session_store.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kHolds = "It holds";

/// A session of three scans that was signed, as incomplete: its other side has never been seen.
class SignedSession : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const fs::path scans = test::write_bumpy_scans(at("scans"), 3);
    run_command({"scan", "--device", "replay:" + scans.string(), "--session", at("signed").string()});
    run_command({"session", "sign", at("signed").string(), "--name", "A. Reader", "--incomplete", "plaster"});
  }
  static void TearDownTestSuite() { delete folder_; }
  [[nodiscard]] static fs::path at(const std::string& name) { return folder_->path() / name; }

  void SetUp() override {
    session_ = at(::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::copy(at("signed"), session_, fs::copy_options::recursive);
    ASSERT_THAT(shown("checklist.html"), HasSubstr(kHolds));
    ASSERT_THAT(shown("report.html"), HasSubstr(kHolds));
  }
  [[nodiscard]] std::string shown(const std::string& name) const {
    return bytes_of(session_ / "export" / name);
  }
  [[nodiscard]] nlohmann::json json_of(const std::string& name) const {
    return nlohmann::json::parse(shown(name));
  }
  Outcome run(const char* verb, const Arguments& more = {}) const {
    Arguments words{verb, session_.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  void say(const Arguments& words) const {
    Arguments all{"session", words.front(), session_.string()};
    all.insert(all.end(), words.begin() + 1, words.end());
    const Outcome said = run_command(all);
    ASSERT_EQ(said.status, 0) << said.err;
  }
  [[nodiscard]] nlohmann::json verified() const { return run("verify", {"--json"}).json(); }

  /// Neither a page nor what lies beside it says anything of a verdict, and all of it is whole.
  void expect_behind(const std::string& what) const {
    for (const char* page : {"checklist.html", "report.html"}) {
      EXPECT_THAT(shown(page), HasSubstr("<h2>Behind</h2>")) << what;
      EXPECT_THAT(shown(page), HasSubstr(what));
      EXPECT_THAT(shown(page), HasSubstr("dubsar plan on the session"));
      EXPECT_THAT(shown(page), Not(HasSubstr(kHolds)));
      EXPECT_THAT(shown(page), Not(HasSubstr("onclusive")));
    }
    EXPECT_EQ(json_of("red_map.json")["conclusive"], false);
    EXPECT_THAT(json_of("red_map.json")["regions"], IsEmpty());
    EXPECT_THAT(json_of("red_map.json")["behind"].get<std::string>(), HasSubstr(what));
    EXPECT_THAT(json_of("poses.json")["scans"], IsEmpty());
    EXPECT_NE(shown("red_map.png"), bytes_of(at("signed") / "export/red_map.png"));
    const nlohmann::json found = verified();
    EXPECT_EQ(found["ok"], true) << found;
    ASSERT_THAT(found["behind"], SizeIs(2)) << what;
    EXPECT_EQ(found["behind"][0]["where"], "export/checklist.html");
  }

  static test::TemporaryFolder* folder_;
  fs::path session_;
};
test::TemporaryFolder* SignedSession::folder_ = nullptr;

TEST_F(SignedSession, WithAScanTakenOutItsPagesAreTakenBackAtOnceAndComeWithThePlan) {
  EXPECT_THAT(verified()["behind"], IsEmpty());
  say({"drop", "2"});
  expect_behind("scan 2 was taken out");
  // Without its poses the plan has no page to give that could be signed.
  EXPECT_EQ(run("plan").status, 1);
  expect_behind("scan 2 was taken out");
  run("register");
  expect_behind("scan 2 was taken out");
  const Outcome planned = run("plan");
  EXPECT_EQ(planned.status, 1) << planned.err;
  for (const char* page : {"checklist.html", "report.html"}) {
    EXPECT_THAT(shown(page), HasSubstr("<h2>Not conclusive</h2>"));
    EXPECT_THAT(shown(page), HasSubstr("It is void: the session has changed since."));
    EXPECT_THAT(shown(page), HasSubstr("scan 2 is no longer part of it"));
    EXPECT_THAT(shown(page), Not(HasSubstr(kHolds)));
  }
  EXPECT_THAT(json_of("poses.json")["scans"], SizeIs(2));
  EXPECT_THAT(json_of("red_map.json")["scans"], SizeIs(2));
  const nlohmann::json found = verified();
  EXPECT_THAT(found["behind"], IsEmpty()) << found;
  EXPECT_EQ(found["ok"], true);
  EXPECT_EQ(bytes_of(session_ / "mesh/model.ply"), bytes_of(at("signed") / "mesh/model.ply"));
}

TEST_F(SignedSession, WithTheNewestUndonePagesAreTakenBack) {
  say({"undo"});
  expect_behind("the newest scan was taken out");
}

TEST_F(SignedSession, WhatIsSaidOfPlacesTakesThemBackUntilItIsFollowed) {
  say({"lock", "1"});
  expect_behind("scan 1 is locked");
  run("plan");
  expect_behind("scan 1 is locked");
  say({"unlock", "1"});
  expect_behind("scan 1 is unlocked");
  run("plan");
  EXPECT_THAT(shown("checklist.html"), HasSubstr(kHolds)) << "nothing is left to follow";
  say({"hint", "2", "--on", "0", "--pose", "0 -1 0 1 1 0 0 2 0 0 1 0 0 0 0 1"});
  expect_behind("scan 2 has a hint");
  say({"hint", "2", "--withdraw"});
  expect_behind("scan 2 has no hint any more");
}

TEST_F(SignedSession, AScanThatIsPutBackBringsThemBackWithTheNextPlan) {
  const std::string map = shown("red_map.json");
  say({"drop", "2"});
  run("plan");
  say({"restore", "2"});
  expect_behind("scan 2 was put back");
  // The red map that it replaces is that of two scans: the signature is held against the one that it keeps.
  const nlohmann::json planned = run("plan", {"--json"}).json();
  EXPECT_EQ(planned["stored"]["same"], false);
  EXPECT_EQ(planned["checklist"]["sign_off"]["holds"], true) << planned["checklist"]["sign_off"];
  EXPECT_THAT(planned["checklist"]["sign_off"]["changed"], IsEmpty());
  EXPECT_THAT(shown("checklist.html"), HasSubstr(kHolds));
  EXPECT_EQ(shown("red_map.json"), map);
  const nlohmann::json found = verified();
  EXPECT_THAT(found["behind"], IsEmpty());
  EXPECT_EQ(found["sign_offs"][0]["holds"], true);
}

TEST_F(SignedSession, ARefusedWordChangesNoPage) {
  EXPECT_EQ(run_command({"session", "drop", session_.string(), "7"}).status, 2);
  EXPECT_EQ(run_command({"session", "unlock", session_.string(), "1"}).status, 2);
  EXPECT_EQ(run_command({"session", "restore", session_.string(), "1"}).status, 0);
  EXPECT_THAT(shown("checklist.html"), HasSubstr(kHolds));
  EXPECT_THAT(verified()["behind"], IsEmpty());
}

TEST_F(SignedSession, PosesThatChangeTakeThemBack) {
  run("register");
  EXPECT_THAT(shown("checklist.html"), HasSubstr(kHolds)) << "the same scans give the same places";
  nlohmann::json moved = json_of("poses.json");
  moved["scans"][1]["model_from_scanner"][3] = moved["scans"][1]["model_from_scanner"][3].get<double>() + 0.1;
  const fs::path file = at("moved.json");
  std::ofstream(file) << moved;
  run("register", {"--from-poses", file.string()});
  expect_behind("the scans were registered anew");
}

TEST_F(SignedSession, AScanThatIsKilledLeavesNoPageThatSaysWhatIsNoLongerSo) {
  const fs::path scans = test::write_bumpy_scans(at("more scans"), 6);
  test::RunningCommand running(
      {"scan", "--device", "replay:" + scans.string(), "--session", session_.string()});
  ASSERT_TRUE(running.says("scan 3 stored"));
  running.send(SIGKILL);
  running.wait();
  expect_behind("scan 3 has come");
  EXPECT_EQ(run("plan").status, 1);
  EXPECT_THAT(shown("checklist.html"), HasSubstr("It is void"));
  EXPECT_THAT(verified()["behind"], IsEmpty());
}

TEST_F(SignedSession, PagesOfAnotherRedMapAreNamedAndMadeAnew) {
  {
    SessionStore store = SessionStore::open(session_).value();
    nlohmann::ordered_json map = nlohmann::ordered_json::parse(**store.load_document("red_map"));
    map["regions"].clear();  // as an earlier version left the pages behind what it kept
    ASSERT_TRUE(store.save_document("red_map", map.dump()));
  }
  const Outcome found = run("verify");
  EXPECT_THAT(found.out, HasSubstr("behind: export/checklist.html: export/red_map.json is not the red map"));
  EXPECT_THAT(run("plan").err, HasSubstr("its pages are behind: export/red_map.json is not the red map"));
  EXPECT_THAT(shown("checklist.html"), HasSubstr(kHolds)) << "it was worked out anew as it was signed";
  EXPECT_THAT(verified()["behind"], IsEmpty());
}

TEST_F(SignedSession, TheChecklistComesWithThePagesWhereTheRedMapIsTheSame) {
  run("plan");
  const std::string map = shown("red_map.json");
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    poses[1].warning = "pin 3 has moved";
    ASSERT_TRUE(store.save_poses(poses));
  }
  const nlohmann::json planned = run("plan", {"--json"}).json();
  EXPECT_EQ(planned["stored"]["same"], true);
  EXPECT_EQ(shown("red_map.json"), map);
  const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
  EXPECT_THAT(**store.load_document("checklist"), HasSubstr("pin 3 has moved"));
  EXPECT_THAT(shown("checklist.html"), HasSubstr("pin 3 has moved"));
}

TEST_F(SignedSession, ARedMapOfTheSameMeaningIsKeptAsThePagesHaveIt) {
  const std::string map = shown("red_map.json");
  {
    SessionStore store = SessionStore::open(session_).value();
    ASSERT_TRUE(store.save_document("red_map", nlohmann::ordered_json::parse(map).dump(2)));
  }
  EXPECT_THAT(verified()["behind"], SizeIs(2));
  EXPECT_EQ(run("plan", {"--json"}).json()["stored"]["same"], true);
  const nlohmann::json found = verified();
  EXPECT_THAT(found["behind"], IsEmpty()) << found["behind"];
  EXPECT_EQ(found["sign_offs"][0]["holds"], true);
}

TEST_F(SignedSession, AScanTooFarAwayForTheModelLeavesNoPageBehind) {
  {
    SessionStore store = SessionStore::open(session_).value();
    std::vector<ScanPose> poses = store.poses().value();
    poses[2].model_from_scanner.translation_mm.x() = 1e9;
    ASSERT_TRUE(store.save_poses(poses));  // as earlier versions kept it
  }
  EXPECT_THAT(verified()["behind"], SizeIs(2));
  run("plan");
  EXPECT_EQ(json_of("poses.json")["scans"][2]["status"], "failed");
  const nlohmann::json found = verified();
  EXPECT_THAT(found["behind"], IsEmpty()) << found["behind"];
}

TEST_F(SignedSession, PagesOfPosesThatFollowNothingDoNotSendToThePlanAlone) {
  nlohmann::json moved = json_of("poses.json");
  moved["scans"][1]["model_from_scanner"][3] = moved["scans"][1]["model_from_scanner"][3].get<double>() + 0.1;
  const fs::path file = at("a bit.json");
  std::ofstream(file) << moved;
  run("register", {"--from-poses", file.string()});
  expect_behind("the scans were registered anew");
  EXPECT_EQ(verified()["behind"][0]["mend"], "run dubsar plan on the session");
  // As a program that is killed before it has poses that follow.
  ASSERT_TRUE(SessionStore::open(session_)->drop_scan(2));
  run("plan");
  expect_behind("scan 2 has been taken out");
  EXPECT_THAT(shown("checklist.html"), HasSubstr("run dubsar register and dubsar plan on the session"));
  EXPECT_EQ(verified()["behind"][0]["mend"], "run dubsar register and dubsar plan on the session");
  run("register");
  run("plan");
  EXPECT_THAT(verified()["behind"], IsEmpty());
}

TEST_F(SignedSession, ASessionWithoutPagesHasNoneThatAreBehind) {
  fs::remove_all(session_ / "export");
  say({"drop", "2"});
  EXPECT_FALSE(fs::exists(session_ / "export" / "checklist.html"));
  EXPECT_THAT(verified()["behind"], IsEmpty());
}

TEST_F(SignedSession, APackageOfItHasPagesOfTheSessionAsItIs) {
  say({"drop", "2"});
  const fs::path package = at("package");
  const Outcome packed = run("export", {"--to", package.string()});
  ASSERT_EQ(packed.status, 0) << packed.err;
  EXPECT_THAT(packed.err, HasSubstr("they are not all of the scans as they stand"));
  EXPECT_THAT(bytes_of(package / "data/report/checklist.html"), HasSubstr("It is void"));
  EXPECT_FALSE(fs::exists(package / "data/kept"));
}

}  // namespace
}  // namespace dubsar
