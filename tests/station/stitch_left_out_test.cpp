// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar stitch says which scans are no part of the mesh, and falls short without one that should be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

/// A folder and a session of the same four scans.
class StitchLeftOut : public ::testing::Test {
 protected:
  StitchLeftOut() : poses_(4) {
    test::write_bumpy_scans(at("scans"), 4);
    for (int k = 0; k < 4; ++k) {
      ScanPose& pose = poses_[static_cast<std::size_t>(k)];
      pose.id = k;
      pose.file = test::scan_name(k);
      pose.status = PoseStatus::kRegistered;
      pose.model_from_scanner = test::bumpy_pose(k);
    }
    poses_[3].status = PoseStatus::kUnsure;
    poses_[3].reason = "two places fit";
    EXPECT_TRUE(write_poses(at("poses.json"), poses_));
    SessionStore store = SessionStore::open_or_create(at("session")).value();
    for (int k = 0; k < 4; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      grid.source = test::scan_name(k);
      EXPECT_TRUE(store.add_grid(grid));
    }
    EXPECT_TRUE(store.save_poses(poses_));
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] Outcome stitched(const std::string& path, const test::Arguments& more = {}) const {
    test::Arguments words{"stitch", at(path), "-o", at("mesh.ply"), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  [[nodiscard]] Outcome with_poses() const { return stitched("scans", {"--poses", at("poses.json")}); }
  void harm(int number) const { std::ofstream(at("scans") + "/" + test::scan_name(number)) << "no scan"; }
  [[nodiscard]] nlohmann::json unsure() const {
    return {{"id", 3}, {"file", test::scan_name(3)}, {"state", "unsure"}, {"reason", "two places fit"}};
  }

  std::vector<ScanPose> poses_;

 private:
  test::TemporaryFolder folder_;
};

TEST_F(StitchLeftOut, NamesAScanThatIsUnsure) {
  for (const Outcome& outcome : {with_poses(), stitched("session"), stitched("session", {"--unless-done"}),
                                 stitched("session", {"--unless-done"})}) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(3) + " is left out: unsure, two places fit"));
    EXPECT_EQ(outcome.json()["left_out"], nlohmann::json::array({unsure()}));
  }
  ASSERT_EQ(run_command({"session", "drop", at("session"), "3"}).status, 0);
  const Outcome outcome = stitched("session");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.json()["left_out"], SizeIs(0)) << "it was taken out";
}

TEST_F(StitchLeftOut, NamesAScanWithoutAPoseAndACopy) {
  fs::copy_file(at("scans") + "/" + test::scan_name(0), at("scans") + "/scan_9.ply");
  poses_[3] = poses_[0];
  poses_[3].file = "scan_9.ply";
  ASSERT_TRUE(write_poses(at("poses.json"), poses_));
  const Outcome outcome = with_poses();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json left_out = outcome.json()["left_out"];
  ASSERT_THAT(left_out, SizeIs(2));
  EXPECT_EQ(left_out[0]["state"], "no_pose");
  EXPECT_EQ(left_out[0]["file"], test::scan_name(3));
  EXPECT_EQ(left_out[1]["state"], "copy");
  EXPECT_EQ(left_out[1]["file"], "scan_9.ply");
  EXPECT_THAT(left_out[1]["reason"], HasSubstr("the very samples of " + test::scan_name(0)));
}

/// Its pose puts a scan well before what the others see.
TEST_F(StitchLeftOut, FallsShortWithoutAScanThatStandsInTheWayWithAllThatItHas) {
  poses_[0].model_from_scanner.translation_mm.z() += 10;
  ASSERT_TRUE(write_poses(at("poses.json"), poses_));
  const std::string told =
      "all of it stands in the way of scans 1 and 2: its pose is wrong, or something lay";
  const Outcome outcome = with_poses();
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(2)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(0) + " is left out: " + told));
  const nlohmann::json said = outcome.json();
  EXPECT_EQ(said["scans"], 2);
  ASSERT_THAT(said["left_out"], SizeIs(2));
  EXPECT_EQ(said["left_out"][1]["id"], 0);
  EXPECT_EQ(said["left_out"][1]["state"], "in_the_way");
  const Outcome planned = run_command({"plan", at("scans"), "--poses", at("poses.json"), "--json"});
  EXPECT_THAT(planned.err, AllOf(HasSubstr(told), Not(HasSubstr("something was in the way"))));
  EXPECT_EQ(planned.json()["left_out"][1]["state"], "in_the_way");
}

TEST_F(StitchLeftOut, FallsShortWithoutAScanOfASession) {
  const fs::path grid = fs::path(at("session")) / "grids/001.grid";
  fs::rename(grid, at("aside"));
  for (const bool again : {false, true}) {
    const Outcome outcome = stitched("session", {"--unless-done"});
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(1) + " is left out: it cannot be read"));
    const nlohmann::json said = outcome.json();
    EXPECT_EQ(said.contains("done_before"), again) << "what falls short is not stitched for ever";
    ASSERT_THAT(said["left_out"], SizeIs(2));
    const nlohmann::json& lost = said["left_out"][again ? 0 : 1];
    EXPECT_EQ(lost["id"], 1);
    EXPECT_EQ(lost["file"], test::scan_name(1));
    EXPECT_EQ(lost["state"], "unreadable");
    EXPECT_THAT(lost["reason"], HasSubstr("grids/001.grid: missing"));
  }
  fs::rename(at("aside"), grid);
  const Outcome mended = stitched("session", {"--unless-done"});
  EXPECT_EQ(mended.status, 0) << mended.err;
  EXPECT_FALSE(mended.json().contains("done_before"));
  EXPECT_EQ(mended.json()["scans"], 3);
}

TEST_F(StitchLeftOut, AScanThatWasUnsureIsNotMissed) {
  fs::remove(fs::path(at("session")) / "grids/003.grid");
  const Outcome outcome = stitched("session");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(test::scan_name(3) + " is left out: it cannot be read"));
  EXPECT_EQ(outcome.json()["left_out"][0]["state"], "unreadable");
  harm(3);
  std::ofstream(at("scans") + "/other.ply") << "no scan";
  EXPECT_EQ(with_poses().status, 0) << "the mesh is of all that the poses have registered";
}

TEST_F(StitchLeftOut, AFileThatCannotBeReadKeepsItsNumber) {
  harm(1);
  const Outcome plain = run_command({"register", at("scans"), "--json"});
  EXPECT_EQ(plain.status, 1) << plain.err;
  std::vector<int> ids;
  const nlohmann::json poses = plain.json();
  for (const nlohmann::json& scan : poses["scans"]) {
    ids.push_back(scan["id"]);
  }
  EXPECT_THAT(ids, ::testing::ElementsAre(0, 2, 3));
  for (ScanPose& pose : poses_) {
    pose.file.clear();  // the numbers alone tell
  }
  ASSERT_TRUE(write_poses(at("numbers.json"), poses_));
  const Outcome placed = run_command({"register", at("scans"), "--from-poses", at("numbers.json"), "--json"});
  EXPECT_EQ(placed.json()["scans"][1]["status"], "registered") << placed.out;
}

TEST_F(StitchLeftOut, NumbersTellWhereNoNameDoes) {
  for (ScanPose& pose : poses_) {
    pose.file = "before/renaming_" + std::to_string(pose.id) + ".ply";
  }
  ASSERT_TRUE(write_poses(at("renamed.json"), poses_));
  const Outcome by_number = stitched("scans", {"--poses", at("renamed.json")});
  EXPECT_EQ(by_number.status, 0) << by_number.err;
  EXPECT_EQ(by_number.json()["scans"], 3);
  EXPECT_THAT(by_number.err, HasSubstr("the poses are taken by `id`"));
  EXPECT_THAT(by_number.complaints(), SizeIs(2)) << "that, and the unsure one: " << by_number.err;
  EXPECT_EQ(run_command({"register", at("scans"), "--from-poses", at("renamed.json"), "--json"})
                .json()["scans"][1]["status"],
            "registered");

  poses_[1].file = test::scan_name(1);  // then the other names are wrong
  ASSERT_TRUE(write_poses(at("some.json"), poses_));
  EXPECT_EQ(stitched("scans", {"--poses", at("some.json")}).json()["scans"], 1);
  poses_[1].file = "another.ply";
  poses_[1].id = 7;  // they do not fit all
  ASSERT_TRUE(write_poses(at("seven.json"), poses_));
  EXPECT_EQ(stitched("scans", {"--poses", at("seven.json")}).status, 2);
}

TEST_F(StitchLeftOut, AScanIsKnownByTheNameOfItsFileToo) {
  const fs::path scans = fs::path(at("renamed"));
  fs::create_directories(scans);
  for (int k = 0; k < 3; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    grid.source = "original_" + std::to_string(k) + ".ply";
    ASSERT_TRUE(write_grid_ply(scans / ("00" + std::to_string(k) + ".ply"), grid, {.keep_source = true}));
  }
  std::vector<ScanPose> poses(poses_.begin(), poses_.begin() + 3);
  for (ScanPose& pose : poses) {
    pose.status = PoseStatus::kRegistered;
    pose.file = "00" + std::to_string(pose.id) + ".ply";
    pose.id = -1;
  }
  poses[0].file = "original_0.ply";  // the others are named all the same
  ASSERT_TRUE(write_poses(at("own.json"), poses));
  const Outcome planned = run_command({"plan", scans.string(), "--poses", at("own.json"), "--json"});
  EXPECT_THAT(planned.json()["left_out"], ::testing::IsEmpty()) << planned.err;
  EXPECT_THAT(planned.json()["scans"], SizeIs(3));
  EXPECT_EQ(stitched("renamed", {"--poses", at("own.json")}).json()["scans"], 3);

  // An original name goes before the name of a file, so that no pose is given twice.
  RangeGrid grid = test::bumpy_scan(0);
  grid.source = "001.ply";
  ASSERT_TRUE(write_grid_ply(scans / "000.ply", grid, {.keep_source = true}));
  poses[0].file = "elsewhere.ply";
  ASSERT_TRUE(write_poses(at("twice.json"), poses));
  const Outcome twice = run_command({"plan", scans.string(), "--poses", at("twice.json"), "--json"});
  ASSERT_THAT(twice.json()["left_out"], SizeIs(1)) << twice.err;
  EXPECT_EQ(twice.json()["left_out"][0]["file"], "original_1.ply");
  EXPECT_EQ(twice.json()["left_out"][0]["state"], "no_pose");
  EXPECT_THAT(twice.err, HasSubstr("original_1.ply"));
}

/// As files are that were numbered anew: each has the original name of the next.
TEST_F(StitchLeftOut, NoPoseIsOfTwoScans) {
  const fs::path scans = fs::path(at("renumbered"));
  fs::create_directories(scans);
  const auto write = [&](const char* file, int number, const char* source) {
    RangeGrid grid = test::bumpy_scan(number);
    grid.source = source;
    ASSERT_TRUE(write_grid_ply(scans / file, grid, {.keep_source = true}));
  };
  const auto said = [&](const char* verb) {
    test::Arguments words{verb, scans.string(), "--poses", at("two.json"), "--json"};
    if (verb == std::string("stitch")) {
      words.insert(words.end(), {"-o", at("mesh.ply")});
    }
    const Outcome outcome = run_command(words);
    EXPECT_THAT(outcome.err, HasSubstr("two.json has no pose of it: the one of its name is another scan's"));
    return outcome.json()["left_out"];
  };
  std::vector<ScanPose> poses(poses_.begin(), poses_.begin() + 2);
  poses[0].file = "a.ply";
  poses[1].file = "c.ply";
  ASSERT_TRUE(write_poses(at("two.json"), poses));
  write("a.ply", 0, "a.ply");
  write("c.ply", 2, "d.ply");  // its file alone is called c.ply, and it may come before or after scan c.ply
  for (const char* file : {"b.ply", "x.ply"}) {
    write(file, 1, "c.ply");
    for (const char* verb : {"plan", "stitch"}) {
      const nlohmann::json left_out = said(verb);
      ASSERT_THAT(left_out, SizeIs(1)) << verb << " " << file;
      EXPECT_EQ(left_out[0]["file"], "d.ply");
      EXPECT_EQ(left_out[0]["state"], "no_pose");
    }
    fs::remove(scans / file);
  }
  // Of two with the one name it is of neither, unless one's file is called so.
  write("b.ply", 1, "c.ply");
  write("x.ply", 2, "c.ply");
  for (const char* verb : {"plan", "stitch"}) {
    EXPECT_THAT(said(verb), SizeIs(3)) << verb;
  }
  write("c.ply", 1, "c.ply");
  for (const char* verb : {"plan", "stitch"}) {
    EXPECT_THAT(said(verb), SizeIs(2)) << verb;
  }
}

TEST_F(StitchLeftOut, OfASessionsScansOfOneNameTheNumberTells) {
  poses_.resize(1);
  poses_[0].id = 5;
  ASSERT_TRUE(write_poses(at("one.json"), poses_));
  EXPECT_EQ(stitched("session", {"--poses", at("one.json")}).json()["scans"], 1) << "its name is its own";
  RangeGrid again = test::bumpy_scan(4);
  again.source = test::scan_name(0);
  ASSERT_TRUE(SessionStore::open(at("session"))->add_grid(again));
  EXPECT_EQ(stitched("session", {"--poses", at("one.json")}).status, 2) << "it may be of either";
  poses_[0].id = 4;
  ASSERT_TRUE(write_poses(at("one.json"), poses_));
  const nlohmann::json numbered = stitched("session", {"--poses", at("one.json")}).json();
  EXPECT_EQ(numbered["scans"], 1);
  EXPECT_EQ(numbered["left_out"][0]["id"], 0);
}

TEST_F(StitchLeftOut, FallsShortWithoutAFileOfAFolder) {
  harm(1);
  for (const Outcome& outcome : {with_poses(), stitched("scans")}) {
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(test::scan_name(1) + " is left out: it cannot be read"),
                                   Not(HasSubstr(test::scan_name(0) + " is left out"))));
    const nlohmann::json left_out = outcome.json()["left_out"];
    nlohmann::json unreadable;
    for (const nlohmann::json& one : left_out) {
      if (one["state"] == "unreadable") {
        unreadable.push_back(one);
      }
    }
    ASSERT_THAT(unreadable, SizeIs(1)) << outcome.out;
    EXPECT_EQ(unreadable[0]["file"], test::scan_name(1));
    EXPECT_FALSE(unreadable[0].contains("id"));
  }
}

}  // namespace
}  // namespace dubsar
