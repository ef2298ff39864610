// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar register and its options: the same bytes every time, and the old poses when it is stopped.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <csignal>
#include <fstream>

#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/acquisition/session_support.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Register : public ::testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] Outcome registered(const Arguments& more, const std::string& what = "scans") const {
    Arguments words{"register", at(what), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Register, GivesTheSameBytesOnEveryRunAndAnyNumberOfThreads) {
  test::write_bumpy_scans(at("scans"), 4);
  const Outcome first = registered({"--threads", "1", "-o", at("one.json")});
  ASSERT_EQ(first.status, 0) << first.err;
  for (const char* threads : {"1", "2", "2", "3"}) {
    const Outcome again = registered({"--threads", threads, "-o", at("again.json")});
    EXPECT_EQ(again.out, first.out) << threads;
    EXPECT_EQ(test::bytes_of(at("again.json")), test::bytes_of(at("one.json"))) << threads;
  }
  EXPECT_EQ(registered({}).out, first.out);
}

TEST_F(Register, TellsOfAScanThatCameTwice) {
  test::write_bumpy_scans(at("scans"), 2);
  fs::copy_file(at("scans") + "/" + test::scan_name(1), at("scans") + "/scan_9.ply");
  const Outcome outcome = registered({});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("scan_9.ply has the very samples of scan_1.ply, and counts as the same scan"));
}

/// Two halves that nothing ties together: scans 0 and 1 of the one, 2 and 3 of the other.
void write_halves(const fs::path& folder) {
  fs::create_directories(folder);
  const auto surface = testing::bumpy(13, 120);
  for (int k = 0; k < 4; ++k) {
    testing::FieldScan scan;
    scan.seed = 20 + static_cast<std::uint64_t>(k);
    (k < 2 ? scan.high_x_mm : scan.low_x_mm) = k < 2 ? -3 : 3;
    const RigidTransform pose = testing::pose_of(3.0 * k, -2.0 * k, 20.0 * k, {1, 0, 0});
    ASSERT_TRUE(write_grid_ply(folder / test::scan_name(k), testing::scan_field(surface, pose, scan)));
  }
}

TEST_F(Register, ScansThatFitOneAnotherAloneAreToldAsAGroup) {
  write_halves(at("scans"));
  const Outcome outcome = registered({});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const nlohmann::json apart = outcome.json()["groups_apart"];
  ASSERT_THAT(apart, SizeIs(1)) << outcome.out;
  EXPECT_EQ(apart[0]["scans"], nlohmann::json({2, 3}));
  const std::string say = apart[0]["say"];
  EXPECT_THAT(say, HasSubstr("scans 2 and 3 fit one another, and not scans 0 and 1; to join them lay the "
                             "tablet as for scan "));
  EXPECT_EQ(outcome.json()["scans"][3]["group_apart"], 2);
  EXPECT_THAT(run_command({"register", at("scans")}).out, HasSubstr("apart: " + say));
  // Of a session everybody says the same, from what is stored.
  const Outcome scanned =
      run_command({"scan", "--device", "replay:" + at("scans"), "--session", at("session"), "--json"});
  EXPECT_EQ(scanned.json()["red_map"]["groups_apart"], apart);
  EXPECT_THAT(scanned.err, HasSubstr(say));
  const Outcome planned = run_command({"plan", at("session"), "--json"});
  EXPECT_EQ(planned.json()["groups_apart"], apart) << planned.out;
  EXPECT_THAT(run_command({"plan", at("session")}).out, HasSubstr("apart: " + say));
  EXPECT_THAT(test::bytes_of(at("session") + "/export/report.html"), HasSubstr("<li>S" + say.substr(1)));
}

TEST_F(Register, OnlyMovesTheScansThatItNames) {
  test::write_bumpy_scans(at("scans"), 4);
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", at("session")});
  const nlohmann::json before = registered({}, "session").json()["scans"];
  ASSERT_THAT(before, SizeIs(4));
  const nlohmann::json after = registered({"--only", "1,3"}, "session").json()["scans"];
  ASSERT_THAT(after, SizeIs(4));
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[2], before[2]);
  for (const int id : {1, 3}) {
    EXPECT_EQ(after[static_cast<std::size_t>(id)]["status"], "registered");
    EXPECT_EQ(after[static_cast<std::size_t>(id)]["locked"], false);
  }
  const nlohmann::json subset = registered({"--only", "0,2"}).json()["scans"];
  ASSERT_THAT(subset, SizeIs(4));
  EXPECT_EQ(subset[2]["status"], "registered");
  EXPECT_EQ(subset[1]["status"], "failed");
  EXPECT_THAT(subset[1]["reason"].get<std::string>(), HasSubstr("left out"));
  const Outcome unknown = registered({"--only", "9"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.complaints(), SizeIs(1)) << unknown.err;
  ASSERT_EQ(run_command({"session", "lock", at("session"), "1"}).status, 0);
  EXPECT_EQ(registered({"--only", "1"}, "session").status, 2);
}

TEST_F(Register, AScanThatCannotBeReadIsToldAndKeepsItsPlace) {
  test::write_bumpy_scans(at("scans"), 4);
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", at("session")});
  const auto place_of_lost = [&] {
    const auto poses = SessionStore::open(at("session"), SessionStore::Access::kReadOnly).value().poses();
    return poses.value().at(2).model_from_scanner.row_major();
  };
  const auto before = place_of_lost();
  test::flip_byte(fs::path(at("session")) / "grids" / "002.grid", 1000);
  const Outcome some = registered({"--only", "1"}, "session");
  EXPECT_EQ(some.status, 1) << some.err;
  EXPECT_EQ(place_of_lost(), before);
  const Outcome all = registered({}, "session");
  EXPECT_EQ(all.status, 1) << all.err;
  ASSERT_THAT(all.json()["scans"], SizeIs(3));
  EXPECT_EQ(all.json()["scans"][2]["status"], "registered");
  EXPECT_EQ(place_of_lost(), before) << "the first scan keeps the frame";
  const Outcome lost = registered({"--only", "2"}, "session");
  EXPECT_EQ(lost.status, 2);
  EXPECT_THAT(lost.err, HasSubstr("scan 2 is damaged"));
  EXPECT_THAT(lost.err, ::testing::Not(HasSubstr("there is no scan 2")));
  ASSERT_EQ(run_command({"session", "drop", at("session"), "3"}).status, 0);
  EXPECT_THAT(registered({"--only", "3"}, "session").err, HasSubstr("scan 3 was taken out"));
  EXPECT_THAT(registered({"--only", "9"}, "session").err, HasSubstr("there is no scan 9"));
}

TEST_F(Register, RefinesPosesOfAFileAndBelievesNone) {
  test::write_bumpy_scans(at("scans"), 3);
  std::vector<ScanPose> given(3);
  for (int k = 0; k < 3; ++k) {
    ScanPose& pose = given[static_cast<std::size_t>(k)];
    pose.id = k;
    pose.file = test::scan_name(k);
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = test::bumpy_pose(k);
  }
  given[1].model_from_scanner = testing::pose_of(1, 1, -1, {0.5, 0.4, -0.2}) * given[1].model_from_scanner;
  given[2].model_from_scanner = testing::pose_of(0, 0, 120, {9, 4, 0}) * given[2].model_from_scanner;
  ASSERT_TRUE(write_poses(at("poses.json"), given));
  const Outcome outcome = registered({"--from-poses", at("poses.json")});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const auto poses = parse_poses(outcome.out, "answer");
  ASSERT_TRUE(poses.has_value());
  EXPECT_EQ(poses->at(1).status, PoseStatus::kRegistered) << poses->at(1).reason;
  EXPECT_LT((poses->at(1).model_from_scanner * Eigen::Vector3d(10, 5, 0) -
             test::bumpy_pose(1) * Eigen::Vector3d(10, 5, 0))
                .norm(),
            0.05);
  EXPECT_NE(poses->at(2).status, PoseStatus::kRegistered);
  EXPECT_FALSE(poses->at(2).reason.empty());
  given.pop_back();
  ASSERT_TRUE(write_poses(at("two.json"), given));
  const nlohmann::json two = registered({"--from-poses", at("two.json")}).json()["scans"];
  EXPECT_EQ(two[1]["status"], "registered");
  EXPECT_THAT(two[2]["reason"].get<std::string>(), HasSubstr("no pose for it"));
  EXPECT_EQ(registered({"--from-poses", at("nothing.json")}).status, 2);
}

void write_conf(const std::string& path, double units_per_mm) {
  std::ofstream conf(path);
  conf.precision(17);
  for (int k = 0; k < 3; ++k) {
    const RigidTransform pose = test::bumpy_pose(k);
    const Eigen::Vector3d t = units_per_mm * pose.translation_mm;
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.rotation).conjugate();
    conf << "bmesh " << test::scan_name(k) << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' ' << q.x()
         << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
}

TEST_F(Register, TakesPosesAsStanfordPublishesThem) {
  test::write_bumpy_scans(at("scans"), 3);
  write_conf(at("scans.conf"), 1.0);
  EXPECT_EQ(registered({"--from-poses", at("scans.conf")}).status, 0);
  const Outcome stitched =
      run_command({"stitch", at("scans"), "--poses", at("scans.conf"), "-o", at("m.ply"), "--json"});
  EXPECT_EQ(stitched.status, 0) << stitched.err;
  // Where --unit makes the grids metres, the .conf's numbers are metres, too.
  fs::create_directory(at("metres"));
  for (int k = 0; k < 3; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    for (std::vector<float>* numbers : {&grid.x, &grid.y, &grid.z}) {
      std::ranges::transform(*numbers, numbers->begin(), [](float mm) { return 0.001F * mm; });
    }
    grid.spacing_mm *= 0.001;
    ASSERT_TRUE(write_grid_ply(fs::path(at("metres")) / test::scan_name(k), grid));
  }
  write_conf(at("metres.conf"), 0.001);
  const Arguments far{"stitch", at("metres"), "--poses", at("metres.conf"), "-o", at("far.ply"), "--json"};
  const Outcome refused = run_command(far);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("--unit m"));
  Arguments told = far;
  told.insert(told.end(), {"--unit", "m"});
  const Outcome in_metres = run_command(told);
  EXPECT_EQ(in_metres.status, 0) << in_metres.err;
  EXPECT_EQ(stitched.json()["components"], in_metres.json()["components"]);
}

TEST_F(Register, TakesRoundsAndRefusesNonsense) {
  test::write_bumpy_scans(at("scans"), 3);
  EXPECT_EQ(registered({"--rounds", "4"}).status, 0);
  EXPECT_EQ(registered({"--no-pins"}).status, 0);
  for (const Arguments& words : {Arguments{"--rounds", "0"},
                                 {"--threads", "0"},
                                 {"--threads", "-1"},
                                 {"--only", "one"},
                                 {"--no-pins", "--pins", at("pins.json")}}) {
    const Outcome outcome = registered(words);
    EXPECT_EQ(outcome.status, 2) << words.front();
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  }
}

TEST_F(Register, StoppedItLeavesTheOldPoses) {
  test::write_bumpy_scans(at("scans"), 6);
  run_command({"scan", "--device", "replay:" + at("scans"), "--session", at("session")});
  ASSERT_EQ(run_command({"session", "drop", at("session"), "0"}).status, 0);
  const auto poses = [&] {
    return run_command({"plan", at("session"), "--poses", at("session") + "/export/poses.json", "--json"})
               .out +
           run_command({"session", "list", at("session"), "--json"}).out;
  };
  const std::string before = poses();
  test::RunningCommand running({"register", at("session"), "--threads", "1"});
  ASSERT_TRUE(running.says("registering"));
  running.send(SIGINT);
  const Outcome stopped = running.wait();
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  EXPECT_EQ(stopped.signal, 0);
  EXPECT_EQ(stopped.out, "");
  EXPECT_THAT(stopped.complaints(), SizeIs(1)) << stopped.err;
  EXPECT_EQ(poses(), before);
  // Nor does the mesh know of a change: the stored poses are those of the scan.
  const Outcome meshed = run_command({"stitch", at("session"), "-o", at("mesh.ply")});
  EXPECT_EQ(meshed.status, 0) << meshed.err;
  EXPECT_EQ(run_command({"verify", at("session")}).status, 0);
}

}  // namespace
}  // namespace dubsar
