// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// session hint, lock, unlock, drop and restore: what the operator says stands, in the session and after it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/station/support/two_fold_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using test::two_fold_click;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class OperatorWordTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { made_ = new test::TemporaryFolder; }
  static void TearDownTestSuite() { delete made_; }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] std::string session() const { return at("session"); }

  void scan_two_fold() const { copy_of_made("two-fold", test::write_two_fold_scans); }
  void scan_bumpy() const {
    copy_of_made("bumpy", [](const fs::path& folder) { test::write_bumpy_scans(folder, 4); });
  }
  [[nodiscard]] Outcome hint(Arguments more) const {
    Arguments words{"session", "hint", session()};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  /// The status, model_from_scanner, … of every scan after `register`.
  [[nodiscard]] nlohmann::json registered(Arguments more = {}) const {
    Arguments words{"register", session(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words).json()["scans"];
  }
  void refused(Arguments more, const char* why) const {
    const Outcome outcome = hint(std::move(more));
    EXPECT_EQ(outcome.status, 2) << why << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(why));
  }

 private:
  /// Its scans and their session, which the first test that wants them makes.
  void copy_of_made(const char* name, const auto& write_scans) const {
    const fs::path made = made_->path() / name;
    if (!fs::exists(made)) {
      write_scans(made / "scans");
      run_command({"scan", "--device", "replay:" + (made / "scans").string(), "--session",
                   (made / "session").string()});
    }
    fs::copy(made, folder_.path(), fs::copy_options::recursive);
  }

  static test::TemporaryFolder* made_;
  test::TemporaryFolder folder_;
};
test::TemporaryFolder* OperatorWordTest::made_ = nullptr;

std::string numbers(const nlohmann::json& matrix) {
  std::string text;
  for (const auto& value : matrix) {
    text.append(text.empty() ? "" : " ").append(value.dump());
  }
  return text;
}

TEST_F(OperatorWordTest, OneClickSettlesWhichOfTwoPoses) {
  scan_two_fold();
  const nlohmann::json before = registered();
  ASSERT_EQ(before[1]["status"], "unsure");
  EXPECT_THAT(before[1]["reason"].get<std::string>(), HasSubstr("click one point on both"));
  for (const bool turned : {false, true}) {
    const Outcome kept = hint({"1", "--on", "0", "--points", two_fold_click(14, -9, turned)});
    ASSERT_EQ(kept.status, 0) << kept.err;
    const nlohmann::json after = registered();
    ASSERT_EQ(after[1]["status"], "registered") << after[1]["reason"];
    const double cosine = after[1]["model_from_scanner"][0].get<double>();
    EXPECT_NEAR(cosine, (turned ? -1 : 1) * test::two_fold_pose(1).rotation(0, 0), 1e-3);
    EXPECT_EQ(run_command({"session", "list", session(), "--json"}).json()["scans"][1]["hint_on"], 0);
  }
  // The online engine has it too when the session goes on, and so it has when the hint is taken back.
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", session()});
  const auto listed = [&] { return run_command({"session", "list", session(), "--json"}).json()["scans"]; };
  EXPECT_EQ(listed()[1]["status"], "registered");
  ASSERT_EQ(hint({"1", "--withdraw"}).status, 0);
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", session()});
  EXPECT_EQ(listed()[1]["status"], "unsure");
  EXPECT_THAT(listed()[1]["reason"].get<std::string>(), HasSubstr("two poses fit"));
}

TEST_F(OperatorWordTest, ARoughPoseOrAFileDoesToo) {
  scan_two_fold();
  const RigidTransform rough = testing::pose_of(3, -2, 4, {1, -1.5, 0.5}) * test::two_fold_pose(1);
  const auto m = rough.row_major();
  std::string text;
  for (const double value : m) {
    text += std::to_string(value) + " ";
  }
  ASSERT_EQ(hint({"1", "--pose", text}).status, 0);
  EXPECT_EQ(registered()[1]["status"], "registered");
  ASSERT_EQ(hint({"1", "--withdraw"}).status, 0);
  ASSERT_EQ(registered()[1]["status"], "unsure");

  std::ofstream(at("hint.json")) << R"({"unit":"mm","on":0,"on_from_scanner":)" << nlohmann::json(m) << "}";
  ASSERT_EQ(hint({"1", "--pose", at("hint.json")}).status, 0);
  EXPECT_EQ(registered()[1]["status"], "registered");
  refused({"1", "--on", "7", "--pose", at("hint.json")}, "about scan 0");
}

TEST_F(OperatorWordTest, BadHintsAreTwoAndOneLine) {
  scan_two_fold();
  const std::string a = two_fold_click(14, -9, false);
  const std::string b = two_fold_click(-12, 5, false);
  refused({"9", "--on", "0", "--points", a}, "no scan 9");
  refused({"1", "--on", "9", "--points", a}, "no scan 9");
  refused({"1", "--on", "1", "--points", a}, "cannot lie on itself");
  refused({"1", "--points", a}, "--on");
  refused({"1", "--on", "0"}, "--points, --pose or --withdraw");
  refused({"1", "--on", "0", "--points", "1,2=3,4,5"}, "no point pair");
  refused({"1", "--on", "0", "--points", a, a}, "one place");
  refused({"1", "--on", "0", "--points", two_fold_click(-14, -9, false), two_fold_click(0, -9, false),
           two_fold_click(14, -9, false)},
          "one line");
  refused({"1", "--on", "0", "--points", "0.014,0.009,0=100,100,0"}, "mm from the nearest sample");
  refused({"1", "--on", "0", "--pose", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1"}, "not a rigid transform");
  refused({"1", "--on", "0", "--pose", "1 0 0 0"}, "16 numbers");
  refused({"1", "--on", "0", "--pose", "1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"}, "16 numbers");
  refused({"1", "--withdraw"}, "no hint for scan 1");
  std::ofstream(at("none.json")) << R"({"on":0,"points":[]})";
  refused({"1", "--points", at("none.json")}, "no point pair");
  std::ofstream(at("both.json"))
      << R"({"on":0,"points":[],"model_from_scanner":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})";
  refused({"1", "--points", at("both.json")}, "must say one of");
  ASSERT_EQ(run_command({"session", "drop", session(), "0"}).status, 0);
  refused({"1", "--on", "0", "--points", a, b}, "the only scan");
  refused({"0", "--on", "1", "--points", a, b}, "taken out");
  const Outcome nowhere = run_command({"session", "hint", at("nowhere"), "1", "--on", "0", "--points", a});
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_EQ(run_command({"verify", session()}).status, 0);
}

TEST_F(OperatorWordTest, APoseThatPutsTheScanAwayNamesTheNumber) {
  scan_bumpy();
  refused({"2", "--on", "0", "--pose", "1 0 0 1e30 0 1 0 0 0 0 1 0 0 0 0 1"}, "by number 4 of the 16: 1e+30");
  refused({"2", "--on", "0", "--pose", "1 0 0 0 0 1 0 -200 0 0 1 0 0 0 0 1"}, "by number 8 of the 16: -200");
  refused({"2", "--pose", "1 0 0 0 0 1 0 0 0 0 1 5000 0 0 0 1"}, "by number 12 of the 16: 5000");
  std::ofstream(at("far.json"))
      << R"({"unit":"m","on":0,"on_from_scanner":[1,0,0,3,0,1,0,0,0,0,1,0,0,0,0,1]})";
  refused({"2", "--pose", at("far.json")}, "by number 4 of the 16: 3000");
  // Beside it, as the other side of a tablet lies, is no mistake.
  EXPECT_EQ(hint({"2", "--on", "0", "--pose", "1 0 0 30 0 1 0 0 0 0 1 -15 0 0 0 1"}).status, 0);
}

TEST_F(OperatorWordTest, ALockedScanStaysWhereItIs) {
  scan_bumpy();
  ASSERT_EQ(run_command({"session", "drop", session(), "0"}).status, 0);
  const nlohmann::json before = run_command({"register", session(), "--json"}).json()["scans"];
  ASSERT_EQ(before.size(), 3U);
  const std::string pose_of_2 = numbers(before[1]["model_from_scanner"]);
  ASSERT_EQ(before[1]["id"], 2);
  ASSERT_EQ(run_command({"session", "lock", session(), "2"}).status, 0);
  // Scan 0, back again, would carry the model's frame away.
  ASSERT_EQ(run_command({"session", "restore", session(), "0"}).status, 0);
  for (int run = 0; run < 2; ++run) {
    const nlohmann::json after = registered();
    ASSERT_EQ(after.size(), 4U);
    EXPECT_EQ(numbers(after[2]["model_from_scanner"]), pose_of_2);
    EXPECT_EQ(after[2]["locked"], true);
    for (const auto& scan : after) {
      EXPECT_EQ(scan["status"], "registered") << scan;
    }
    // The online engine keeps it too.
    run_command({"scan", "--device", "replay:" + at("scans"), "--session", session()});
    const auto online = read_poses(fs::path(session()) / "export" / "poses.json");
    ASSERT_TRUE(online.has_value());
    EXPECT_EQ(numbers(nlohmann::json(online->at(2).model_from_scanner.row_major())), pose_of_2);
  }
  refused({"2", "--on", "0", "--points", "0,0,0=0,0,0"}, "locked");
  ASSERT_EQ(run_command({"session", "unlock", session(), "2"}).status, 0);
  EXPECT_EQ(run_command({"session", "unlock", session(), "2"}).status, 2);
  const nlohmann::json unlocked = registered();
  EXPECT_EQ(unlocked[2]["locked"], false);
  EXPECT_EQ(numbers(unlocked[0]["model_from_scanner"]),
            "1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0");
}

TEST_F(OperatorWordTest, OnlyAScanWithAPlaceIsLocked) {
  scan_two_fold();
  const Outcome unsure = run_command({"session", "lock", session(), "1"});
  EXPECT_EQ(unsure.status, 2);
  EXPECT_THAT(unsure.complaints(), SizeIs(1));
  EXPECT_THAT(unsure.err, HasSubstr("not registered"));
  EXPECT_EQ(run_command({"session", "lock", session(), "9"}).status, 2);
}

TEST_F(OperatorWordTest, WhatIsTakenOutAndPutBackIsAsBefore) {
  scan_bumpy();
  struct Chain {
    std::string poses, red_map, mesh;
  };
  const auto follow = [&] {
    const std::string mesh = at("mesh.ply");
    const Outcome poses = run_command({"register", session(), "--json"});
    const Outcome map = run_command({"plan", session(), "--json"});
    run_command({"stitch", session(), "-o", mesh});
    return Chain{poses.out, test::red_map_of(map), test::bytes_of(mesh)};
  };
  const Chain before = follow();
  ASSERT_THAT(nlohmann::json::parse(before.poses)["scans"], SizeIs(4));
  for (const char* how : {"undo", "drop"}) {
    Arguments words{"session", how, session()};
    if (how == std::string("drop")) {
      words.emplace_back("1");
    }
    ASSERT_EQ(run_command(words).status, 0);
    // The red map and the mesh follow even before the scans are registered anew.
    const nlohmann::json without = run_command({"plan", session(), "--json"}).json();
    EXPECT_THAT(without["scans"], SizeIs(3));
    const Chain meanwhile = follow();
    EXPECT_THAT(nlohmann::json::parse(meanwhile.poses)["scans"], SizeIs(3));
    EXPECT_THAT(nlohmann::json::parse(meanwhile.red_map)["scans"], SizeIs(3));
    EXPECT_NE(meanwhile.mesh, before.mesh);
    ASSERT_EQ(run_command({"session", "restore", session(), how == std::string("undo") ? "3" : "1"}).status,
              0);
    const Chain after = follow();
    EXPECT_EQ(after.poses, before.poses);
    EXPECT_EQ(after.red_map, before.red_map);
    EXPECT_EQ(after.mesh, before.mesh);
  }
  EXPECT_EQ(run_command({"verify", session()}).status, 0);
}

}  // namespace
}  // namespace dubsar
