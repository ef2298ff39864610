// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar calibrate, from the command line: sets that are good, that lack something, that are of no use, and
// the time that a verification counts from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "core/range_grid.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/calibration_set.h"
#include "formats/grid_file.h"
#include "formats/grid_ply.h"
#include "formats/verification_log.h"
#include "sim/frame_rig.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

/// A turntable's pictures, rendered once; each test takes as much of the list as it wants.
class Calibrate : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    rendered_ = new test::TemporaryFolder();
    const Outcome made = run_command({"simulate", "rig", "--motion", "turntable", "--poses", "9", "--stops",
                                      "3", "--width", "768", "--height", "408", "-o", pictures().string()});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete rendered_;
    rendered_ = nullptr;
  }
  static fs::path pictures() { return rendered_->path() / "pictures"; }
  void list(std::size_t poses, std::size_t stops, const std::string& more = {}) {
    const Result<std::string> text = read_whole_file(pictures() / "calibration.toml");
    ASSERT_TRUE(text.has_value());
    Result<CalibrationSet> set = parse_calibration_set(*text, "list");
    ASSERT_TRUE(set.has_value());
    fs::remove_all(set_);
    fs::copy(pictures(), set_, fs::copy_options::recursive);
    set->poses.resize(std::min(poses, set->poses.size()));
    set->stops.resize(std::min(stops, set->stops.size()));
    ASSERT_TRUE(write_file_atomically(set_ / "calibration.toml", more + calibration_set_to_toml(*set)));
  }
  Outcome calibrate(Arguments more = {}) {
    Arguments words{"calibrate", set_.string(), "-o", out().string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  [[nodiscard]] fs::path out() const { return folder_.path() / "out.json"; }
  static test::TemporaryFolder* rendered_;
  test::TemporaryFolder folder_;
  fs::path set_ = folder_.path() / "set";
};
test::TemporaryFolder* Calibrate::rendered_ = nullptr;

TEST_F(Calibrate, ATurntableWithTheTemperatureOfTheRoom) {
  list(9, 3);
  const Outcome made = calibrate({"--temperature", "21.5"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("stage: turntable"));
  EXPECT_THAT(made.out, Not(HasSubstr("next:")));
  const Result<std::string> text = read_whole_file(out());
  ASSERT_TRUE(text.has_value());
  const Result<RigCalibration> rig = parse_calibration(*text, "out.json");
  ASSERT_TRUE(rig.has_value()) << rig.error().line();
  EXPECT_EQ(rig->motion.kind, MotionKind::kTurntable);
  EXPECT_EQ(rig->temperature_c, 21.5);
  EXPECT_EQ(rig->camera_serial, "SIM-CAMERA");
  EXPECT_LT(rig->quality.stage_rms_um, 20);
  EXPECT_EQ(calibrate({"--temperature", "900"}).status, 2);
}

/// Of several stations that read one calibration all have the new one.
TEST_F(Calibrate, ALinkToTheCalibrationStaysAndTheFileBehindItIsTheNewOne) {
  list(9, 3);
  const fs::path shared = folder_.path() / "shared.json";
  RigCalibration before = sim::frame_rig({});
  before.made_at = "2026-01-02T03:04:05Z";
  before.camera_serial = "SIM-CAMERA";
  ASSERT_TRUE(write_file_atomically(shared, calibration_to_json(before)));
  fs::create_symlink("shared.json", out());
  const Outcome made = calibrate();
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(fs::is_symlink(out()));
  const Result<std::string> text = read_whole_file(shared);
  ASSERT_TRUE(text.has_value());
  const Result<RigCalibration> now = parse_calibration(*text, "shared.json");
  ASSERT_TRUE(now.has_value()) << now.error().line();
  EXPECT_NE(now->made_at, before.made_at);
}

TEST_F(Calibrate, TheCalibrationOfAnotherCameraIsNotReplaced) {
  list(2, 3);
  RigCalibration other = sim::frame_rig({});
  other.made_at = "2026-01-02T03:04:05Z";
  other.camera_serial = "CAM-A";
  const std::string before = calibration_to_json(other);
  ASSERT_TRUE(write_file_atomically(out(), before));
  const Outcome refused = calibrate();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.complaints(), SizeIs(1)) << refused.err;
  EXPECT_THAT(refused.err,
              HasSubstr("it is the calibration of camera CAM-A, the pictures are of SIM-CAMERA"));
  EXPECT_EQ(*read_whole_file(out()), before);
  // Nor by pictures of which nobody knows the camera.
  const Result<std::string> text = read_whole_file(set_ / "calibration.toml");
  Result<CalibrationSet> set = parse_calibration_set(*text, "list");
  ASSERT_TRUE(set);
  set->camera_serial.clear();
  ASSERT_TRUE(write_file_atomically(set_ / "calibration.toml", calibration_set_to_toml(*set)));
  const Outcome unknown = calibrate();
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("nobody says of which camera the pictures are"));
  EXPECT_EQ(*read_whole_file(out()), before);
  // Its own is made anew.
  EXPECT_EQ(calibrate({"--serial", "CAM-A"}).status, 1) << "of two poses";
  EXPECT_NE(*read_whole_file(out()), before);
}

TEST_F(Calibrate, WhatIsMissingIsSaidWithStatusOne) {
  list(2, 3);
  const Outcome few = calibrate();
  EXPECT_EQ(few.status, 1) << few.err;
  EXPECT_THAT(few.out, HasSubstr("next: tilt the board"));
  EXPECT_THAT(few.out, HasSubstr("next: take more pictures of the board, each tilted another way: 5"));
}

TEST_F(Calibrate, ABadSetIsOneLineAndNoFile) {
  list(9, 1);
  Outcome refused = calibrate();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("the board was seen on the stage at 1 positions, 3 are the least"));
  list(0, 3);  // the stage was looked at first
  refused = calibrate();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("there is no pose of the board yet"));
  list(9, 3);
  refused = calibrate({"--board", "chessboard:9x6:25"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("pictures without a board"));
  fs::remove(set_ / "pose_03.png");
  refused = calibrate();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("pose_03.png"));
  list(9, 3, "colour = \"red\"\n");
  EXPECT_EQ(calibrate().status, 2);
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_EQ(run_command({"calibrate", (folder_.path() / "none").string()}).status, 2);
}

TEST(CalibrateBoard, PrintedWithJsonIsOneObject) {
  const test::TemporaryFolder folder;
  const std::string picture = (folder.path() / "board.png").string();
  const Outcome printed =
      run_command({"calibrate", "--board", "chessboard:9x6:25", "--print", picture, "--json"});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.json()["picture"], picture) << printed.out;
  EXPECT_EQ(printed.json()["square_mm"], 25.0);
  EXPECT_NEAR(printed.json()["dots_per_inch"], 101.6, 1e-9);
}

TEST_F(Calibrate, ThePicturesOfOneCameraAreNoCalibrationOfAnother) {
  list(9, 3);
  const Outcome other = calibrate({"--serial", "OTHER"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("are of camera SIM-CAMERA, not of OTHER"));
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_EQ(calibrate({"--serial", "SIM-CAMERA"}).status, 0);
}

TEST(CalibrateOptions, NothingThatIsSaidPassesUnheard) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  const std::vector<std::pair<Arguments, const char*>> said{
      {{"calibrate", at("scan.ply"), "--verify", at("bar.toml"), "--rig", at("rig.toml")},
       "--rig says nothing with --verify; name the rig's file with --calibration"},
      {{"calibrate", at("scan.ply"), "--verify", at("bar.toml"), "-o", at("out.json")},
       "--out says nothing with --verify; leave it out"},
      {{"calibrate", "--board", "chessboard:9x6:25", "--print", at("b.png"), "--serial", "7"},
       "--serial says nothing with --print; leave it out"},
      {{"calibrate", at("pictures"), "--stops", "7"}, "--stops says nothing without --rig"}};
  for (const auto& [words, answer] : said) {
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(answer));
  }
  EXPECT_TRUE(fs::is_empty(folder.path())) << "nothing was made";
}

/// A plate, measured some time or other.
class VerifiedWhen : public ::testing::Test {
 protected:
  void SetUp() override {
    RigCalibration rig = sim::frame_rig({});
    rig.made_at = "2026-01-02T03:04:05Z";
    ASSERT_TRUE(write_file_atomically(at("calibration.json"), calibration_to_json(rig)));
    ASSERT_TRUE(write_file_atomically(at("plate.toml"),
                                      "name = \"plate\"\ncertificate = \"none\"\nplane = true\n[limit]\n"
                                      "flatness_um = 60\n"));
  }
  static RangeGrid plate(std::int64_t timestamp_ns) {
    constexpr int kSide = 60;
    RangeGrid grid;
    grid.allocate(kSide, kSide);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      grid.x[i] = 0.2F * static_cast<float>(grid.col_of(i));
      grid.y[i] = 0.2F * static_cast<float>(grid.row_of(i));
      grid.z[i] = 0.002F * std::sin(static_cast<float>(i));
      grid.valid[i] = 1;
    }
    grid.timestamp_ns = timestamp_ns;
    return grid;
  }
  Outcome verify(const std::string& scan) {
    return run_command({"calibrate", at(scan), "--verify", at("plate.toml"), "--calibration",
                        at("calibration.json"), "--json"});
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] std::vector<VerificationEntry> log() const {
    const auto read = read_verification_log(verification_log_of(at("calibration.json")));
    return read ? read->entries : std::vector<VerificationEntry>{};
  }
  test::TemporaryFolder folder_;
};

TEST_F(VerifiedWhen, AGridThatSaysItsTimeCountsFromThen) {
  ASSERT_TRUE(write_grid_file(at("plate.grid"), plate(1'767'400'000'000'000'000)));
  const Outcome outcome = verify("plate.grid");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["when"], "2026-01-03T00:26:40Z");
  EXPECT_EQ(outcome.json()["time_unknown"], false);
  ASSERT_THAT(log(), SizeIs(1));
  EXPECT_EQ(log()[0].when, "2026-01-03T00:26:40Z");
}

TEST_F(VerifiedWhen, AFolderOfSeveralScansIsNotJudgedByItsFirst) {
  fs::create_directories(at("scans"));
  ASSERT_TRUE(write_grid_file(at("scans/a.grid"), plate(1'767'400'000'000'000'000)));
  EXPECT_EQ(verify("scans").status, 0) << "a folder of one is that one";
  ASSERT_TRUE(write_grid_file(at("scans/b.grid"), plate(1'767'400'060'000'000'000)));
  const Outcome several = verify("scans");
  EXPECT_EQ(several.status, 2);
  EXPECT_THAT(several.err, HasSubstr("there is more than one scan in it"));
  EXPECT_THAT(log(), SizeIs(1));
}

TEST_F(VerifiedWhen, AFileWithoutATimeCountsFromNowAndThatIsSaid) {
  ASSERT_TRUE(write_grid_ply(at("plate.ply"), plate(0)));
  const Outcome outcome = verify("plate.ply");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["time_unknown"], true);
  EXPECT_EQ(outcome.json()["camera_unknown"], true);
  // A time since the machine was started, or one that has not come, is none.
  for (const std::int64_t odd : {std::int64_t{40'000'000'000}, std::int64_t{9'000'000'000'000'000'000}}) {
    ASSERT_TRUE(write_grid_file(at("odd.grid"), plate(odd)));
    EXPECT_EQ(verify("odd.grid").json()["time_unknown"], true) << odd;
  }
}

TEST_F(VerifiedWhen, AScanThatIsOlderThanTheCalibrationProvesNothingOfIt) {
  ASSERT_TRUE(write_grid_file(at("plate.grid"), plate(1'767'000'000'000'000'000)));
  const Outcome outcome = verify("plate.grid");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("the scan is of 2025-12-29T09:20:00Z, the calibration was made later, on "
                        "2026-01-02T03:04:05Z"));
  EXPECT_THAT(log(), SizeIs(0));
}

TEST_F(VerifiedWhen, AScanOfAnotherCameraProvesNothing) {
  const auto of_device = [&](const std::string& device) {
    RangeGrid grid = plate(1'767'400'000'000'000'000);
    grid.device = device;
    EXPECT_TRUE(write_grid_file(at("plate.grid"), grid));
    return verify("plate.grid");
  };
  const Outcome refused = of_device("bench, camera OTHER-CAMERA");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("the scan is of camera OTHER-CAMERA, the calibration of camera SIM-CAMERA"));
  EXPECT_THAT(log(), SizeIs(0));
  for (const char* same : {"SIM-CAMERA", "bench, camera SIM-CAMERA"}) {
    const Outcome outcome = of_device(same);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["camera_unknown"], false);
  }
  EXPECT_THAT(log(), SizeIs(2));
  // A rig whose camera tells no number writes its own name, which a calibration does not know.
  EXPECT_EQ(of_device("bench").json()["camera_unknown"], true);
  ASSERT_TRUE(write_file_atomically(at("rig.toml"),
                                    "name = \"bench\"\ncamera = \"eye:\"\nstage = \"none:\"\ncalibration = "
                                    "\"calibration.json\"\n[scan]\nfrom_mm = 0\nto_mm = 1\nstep_mm = 0.1\n"));
  const Outcome named = run_command({"calibrate", at("plate.grid"), "--verify", at("plate.toml"),
                                     "--calibration", at("rig.toml"), "--json"});
  EXPECT_EQ(named.status, 0) << named.err;
  EXPECT_EQ(named.json()["camera_unknown"], true);
}

}  // namespace
}  // namespace dubsar
