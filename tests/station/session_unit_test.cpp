// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Numbers that are not what they were said to be, through the command: it is told, and what is advised works.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <map>

#include "formats/pins_json.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using test::scan_name;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kScans = 3;

class SessionUnit : public ::testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  /// The scans in metres; what their files say of that is `unit`.
  void write_metres(const std::string& folder, const std::string& unit) const {
    fs::create_directories(at(folder));
    for (int k = 0; k < kScans; ++k) {
      RangeGrid grid = test::bumpy_scan(k);
      for (std::vector<float>* numbers : {&grid.x, &grid.y, &grid.z}) {
        std::ranges::transform(*numbers, numbers->begin(), [](float mm) { return 0.001F * mm; });
      }
      grid.spacing_mm = 0;
      const fs::path file = fs::path(at(folder)) / scan_name(k);
      ASSERT_TRUE(write_grid_ply(file, grid));
      std::string bytes = test::bytes_of(file);
      const std::string line = "obj_info unit mm\n";
      bytes.replace(bytes.find(line), line.size(), unit.empty() ? "" : "obj_info unit " + unit + "\n");
      std::ofstream(file, std::ios::binary) << bytes;
    }
  }
  [[nodiscard]] Outcome scan(const Arguments& more, const char* session) const {
    Arguments words{"scan", "--device", "replay:" + at("scans"), "--session", at(session), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  [[nodiscard]] std::size_t stored_in(const char* session) const {
    return run_command({"session", "list", at(session), "--json"}).json()["scans"].size();
  }
  void write_conf(const std::string& name, double units_per_mm) const {
    std::ofstream conf(at(name));
    conf.precision(17);
    for (int k = 0; k < kScans; ++k) {
      const RigidTransform pose = test::bumpy_pose(k);
      const Eigen::Vector3d t = units_per_mm * pose.translation_mm;
      const Eigen::Quaterniond q = Eigen::Quaterniond(pose.rotation).conjugate();
      conf << "bmesh " << scan_name(k) << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' ' << q.x() << ' '
           << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
    }
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(SessionUnit, WhatIsAdvisedToWhoForgotItWorks) {
  write_metres("scans", "");
  const Outcome forgotten = scan({}, "wrong");
  EXPECT_EQ(forgotten.status, 1) << forgotten.err;
  EXPECT_THAT(forgotten.json()["poses"]["scans"][0]["reason"].get<std::string>(),
              AllOf(HasSubstr("--unit m"), HasSubstr("scan into a new one")));
  // A session is in millimetres whatever is said.
  for (const char* verb : {"register", "plan", "stitch"}) {
    Arguments words{verb, at("wrong"), "--unit", "m"};
    if (words.front() == "stitch") {
      words.insert(words.end(), {"-o", at("mesh.ply")});
    }
    const Outcome refused = run_command(words);
    EXPECT_EQ(refused.status, 2) << refused.err;
    EXPECT_THAT(refused.complaints(), ElementsAre(AllOf(HasSubstr("--unit says nothing of a session"),
                                                        HasSubstr("--session NEW"))));
  }
  const Outcome same = scan({"--unit", "m"}, "wrong");
  EXPECT_EQ(same.status, 2) << same.err;
  EXPECT_THAT(same.complaints(), ElementsAre(AllOf(HasSubstr("in another unit, 1000 times smaller"),
                                                   HasSubstr("begin a new session"))));
  EXPECT_EQ(stored_in("wrong"), static_cast<std::size_t>(kScans));
  const Outcome right = scan({"--unit", "m"}, "right");
  EXPECT_THAT(right.err, Not(HasSubstr("error"))) << right.err;
  for (const nlohmann::json& pose : right.json()["poses"]["scans"]) {
    EXPECT_EQ(pose["status"], "registered") << pose;
  }
  // Taken out, they may come again in their right unit.
  for (const char* id : {"0", "1", "2"}) {
    ASSERT_EQ(run_command({"session", "drop", at("wrong"), id}).status, 0);
  }
  const Outcome again = scan({"--unit", "m"}, "wrong");
  EXPECT_EQ(again.json()["poses"]["scans"].size(), static_cast<std::size_t>(kScans)) << again.err;
  for (const nlohmann::json& pose : again.json()["poses"]["scans"]) {
    EXPECT_EQ(pose["status"], "registered") << pose;
  }
}

TEST_F(SessionUnit, TheUnitIsSaidOnceAndOfFiles) {
  test::write_bumpy_scans(at("scans"), 1);
  const auto answered = [&](const std::string& device, const char* unit) {
    return run_command({"scan", "--device", device, "--unit", unit, "--session", at("session")});
  };
  EXPECT_THAT(answered("replay:" + at("scans") + "?unit=m", "um").complaints(),
              ElementsAre(HasSubstr("--unit um contradicts unit=m")));
  EXPECT_THAT(answered("sim:", "mm").complaints(), ElementsAre(HasSubstr("--unit is of files")));
  EXPECT_EQ(answered("replay:" + at("scans"), "ell").status, 2);
  EXPECT_FALSE(fs::exists(at("session")));
  EXPECT_EQ(answered("replay:" + at("scans") + "?unit=mm", "mm").status, 1) << "one scan shows not all of it";
}

TEST_F(SessionUnit, AConfIsInTheUnitThatItsScansState) {
  write_metres("scans", "m");
  write_conf("metres.conf", 0.001);
  const auto stitched = [&](const std::string& poses) {
    return run_command({"stitch", at("scans"), "--poses", at(poses), "-o", at("mesh.ply"), "--json"});
  };
  const Outcome theirs = stitched("metres.conf");
  EXPECT_EQ(theirs.status, 0) << theirs.err;
  EXPECT_THAT(theirs.complaints(), ElementsAre(HasSubstr("poses say no sigma_mm"))) << theirs.err;
  EXPECT_EQ(theirs.json()["components"], 1);
  EXPECT_EQ(run_command({"register", at("scans"), "--from-poses", at("metres.conf")}).status, 0);
  // One that is not: no folder of scans is in two units by intent.
  test::write_bumpy_scans(at("millimetres"), 1);
  fs::copy_file(at("millimetres") + "/" + scan_name(0), at("scans") + "/" + scan_name(0),
                fs::copy_options::overwrite_existing);
  const Outcome mixed = stitched("metres.conf");
  EXPECT_EQ(mixed.status, 2);
  EXPECT_THAT(mixed.complaints(), ElementsAre(HasSubstr("in another unit than those of")));
}

TEST_F(SessionUnit, PosesInAnotherUnitThanTheirScansAreTold) {
  // A scanner that stands off, as they do: the places of its scans are in the translations.
  constexpr float kAwayMm = 150;
  fs::create_directories(at("scans"));
  for (int k = 0; k < kScans; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    std::ranges::transform(grid.z, grid.z.begin(), [](float z) { return z - kAwayMm; });
    ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / scan_name(k), grid));
  }
  const auto told_of = [&](double factor) {
    std::vector<ScanPose> poses;
    for (int k = 0; k < kScans; ++k) {
      ScanPose& pose = poses.emplace_back();
      pose.id = k;
      pose.file = scan_name(k);
      pose.status = PoseStatus::kRegistered;
      pose.model_from_scanner = test::bumpy_pose(k);
      pose.model_from_scanner.translation_mm =
          factor * (test::bumpy_pose(k) * Eigen::Vector3d(0, 0, kAwayMm));
    }
    EXPECT_TRUE(write_poses(at("poses.json"), poses));
    return std::vector<std::string>{
        run_command({"plan", at("scans"), "--poses", at("poses.json")}).err,
        run_command({"stitch", at("scans"), "--poses", at("poses.json"), "-o", at("m.ply")}).err};
  };
  EXPECT_THAT(told_of(1), Each(Not(HasSubstr("1000 times"))));
  EXPECT_THAT(told_of(0.001), Each(HasSubstr("poses.json: its translations look 1000 times too small")));
}

TEST_F(SessionUnit, PinsThatCannotBeRightAreTold) {
  test::write_bumpy_scans(at("scans"), 2);
  const auto told_of = [&](const std::map<int, std::vector<PinTip>>& tips) {
    EXPECT_TRUE(write_pins(at("pins.json"), PinSet{1.0, tips}));
    return std::vector<std::string>{run_command({"register", at("scans"), "--pins", at("pins.json")}).err,
                                    run_command({"scan", "--device", "replay:" + at("scans"), "--session",
                                                 at("session"), "--pins", at("pins.json")})
                                        .err};
  };
  const auto tips_in = [](int scan, double factor) {
    const RangeGrid grid = test::bumpy_scan(scan);
    std::vector<PinTip> tips;
    for (const int part : {1, 2, 3}) {
      const std::size_t i = grid.index(grid.rows / 2, grid.cols * (part + 1) / 6);
      tips.push_back({-1, factor * (grid.point(i).cast<double>() + Eigen::Vector3d(0, 0, 0.5))});
    }
    return tips;
  };
  EXPECT_THAT(told_of({{0, tips_in(0, 1)}, {1, tips_in(1, 1)}}), Each(Not(HasSubstr("cannot be right"))));
  fs::remove_all(at("session"));
  EXPECT_THAT(
      told_of({{0, tips_in(0, 1000)}, {1, tips_in(1, 0.001)}, {77, tips_in(0, 1)}}),
      Each(AllOf(HasSubstr(scan_name(0) + ": its pins cannot be right: 3 of them lie farther outside"),
                 HasSubstr(scan_name(1) + ": its pins cannot be right: "),
                 HasSubstr("pins.json: it has pins of scan 77, which is not there"))));
}

/// As `stitch` does: a verdict that rests on fewer scans than there are says on which it does not.
TEST_F(SessionUnit, PlanSaysWhichScansItLeavesOut) {
  test::write_bumpy_scans(at("scans"), kScans);
  ASSERT_TRUE(write_grid_ply(fs::path(at("scans")) / scan_name(1), test::bumpy_scan(1, 99)));
  std::ofstream(at("scans") + "/zz.ply") << "ply\nformat ascii 1.0\nelement vertex 9\n";
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", at("session")});
  for (const char* what : {"scans", "session"}) {
    const Outcome planned = run_command({"plan", at(what), "--json"});
    EXPECT_EQ(planned.status, 1);
    EXPECT_THAT(planned.err, HasSubstr(scan_name(1) + " is left out: "));
    const nlohmann::json left_out = planned.json()["left_out"];
    ASSERT_THAT(left_out, SizeIs(std::string(what) == "scans" ? 2 : 1)) << planned.out;
    EXPECT_EQ(left_out[0]["id"], 1);
    EXPECT_EQ(left_out[0]["file"], scan_name(1));
    EXPECT_FALSE(left_out[0]["reason"].get<std::string>().empty());
    EXPECT_EQ(planned.json()["scans"].size(), 2U);
  }
  const nlohmann::json damaged = run_command({"plan", at("scans"), "--json"}).json()["left_out"][1];
  EXPECT_EQ(damaged["file"], "zz.ply");
  EXPECT_EQ(damaged["state"], "unreadable");
  EXPECT_FALSE(damaged.contains("id"));
  // None of them: the one thing that there is to say.
  write_metres("metres", "");
  const Outcome none = run_command({"plan", at("metres")});
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, AllOf(HasSubstr("--unit m"), HasSubstr("no scan is registered")));
  EXPECT_EQ(none.out, "not conclusive\n") << "a table of zeros would say that nothing is red";
}

}  // namespace
}  // namespace dubsar
