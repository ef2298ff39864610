// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Calibration and its daily check, by clicks in the real window.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "build_paths.h"
#include "core/range_grid.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "formats/calibration_set.h"
#include "formats/grid_ply.h"
#include "formats/verification_log.h"
#include "sim/frame_rig.h"
#include "station/calibration_run.h"
#include "station/verification.h"
#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kRig = R"(name = "bench"
camera = "eye:"
stage = "none:"
calibration = "calibration.json"
[scan]
from_mm = -5
to_mm = 5
step_mm = 0.1
)";

constexpr const char* kRangeRig = R"(name = "head"
camera = "eye:"
stage = "none:"
[motion]
kind = "linear"
direction = [0, 1, 0]
[scan]
from_mm = -5
to_mm = 5
step_mm = 0.1
speed_mm_s = 5
)";

constexpr const char* kBall = R"(name = "ball 7"
certificate = "D-K-7"
[limit]
form_um = 60
size_um = 20
[[ball]]
diameter_mm = {}
center_mm = [0, 0, 0]
)";

/// A ball of 12 mm on a table, from above.
void write_scan_of_a_ball(const fs::path& file) {
  constexpr int kSide = 160;
  constexpr double kStep = 0.15;
  RangeGrid grid;
  grid.allocate(kSide, kSide);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const double x = kStep * (col - kSide / 2);
      const double y = kStep * (row - kSide / 2);
      const double under = 36 - x * x - y * y;
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(under > 0 ? std::max(0.0, 5 + std::sqrt(under)) : 0);
      grid.valid[i] = 1;
    }
  }
  ASSERT_TRUE(write_grid_ply(file, grid).has_value());
}

class CalibrationBox : public test::OnADisplay {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(OnADisplay::SetUp());
    ASSERT_TRUE(write_file_atomically(at("rig.toml"), kRig).has_value());
    RigCalibration rig = sim::frame_rig({});
    rig.made_at = "2026-01-02T03:04:05Z";
    ASSERT_TRUE(write_file_atomically(at("calibration.json"), calibration_to_json(rig)).has_value());
  }
  Outcome play(const std::string& script) {
    const fs::path file = at("box.script");
    std::ofstream(file) << script;
    return run_command(
        {"station", "--session", at("session").string(), "--device", "rig:" + at("rig.toml").string(),
         "--script", file.string()},
        {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/window"}});
  }
  void certify(double diameter_mm) {
    std::string text = kBall;
    text.replace(text.find("{}"), 2, std::to_string(diameter_mm));
    ASSERT_TRUE(write_file_atomically(at("artefact.toml"), text).has_value());
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] std::vector<VerificationEntry> log() const {
    const auto read = read_verification_log(verification_log_of(at("calibration.json")));
    return read ? read->entries : std::vector<VerificationEntry>{};
  }
  /// Empties the line and types into it.
  static std::string retype(const std::string& line, const std::string& text) {
    return "click " + line + "\nkey selectall\ntype " + text + "\n";
  }
};

TEST_F(CalibrationBox, TheDailyMeasurementIsAskedForDoneAndLogged) {
  write_scan_of_a_ball(at("ball.ply"));
  certify(12.0);
  const std::string scan = retype("verify-scan", at("ball.ply").string());
  const Outcome passed =
      play("wait idle\nwait verify-due 10\nclick calibration\nwait verify-artefact\n" + scan +
           "click verify-now\nwait verify-passed\nwait verified-today\n"
           "click close-calibration\nquit\n");
  ASSERT_EQ(passed.status, 0) << passed.err;
  ASSERT_THAT(log(), SizeIs(1));
  EXPECT_TRUE(log()[0].passed);
  EXPECT_EQ(log()[0].artefact, "ball 7");
  // The next morning the ball measures wrong; that is kept as well, and the rig stays due.
  certify(12.2);
  const Outcome failed = play("wait idle\nwait verified-today 10\nclick calibration\nwait verify-artefact\n" +
                              scan + "click verify-now\nwait verify-failed\nwait verify-due\nquit\n");
  ASSERT_EQ(failed.status, 0) << failed.err;
  ASSERT_THAT(log(), SizeIs(2));
  EXPECT_FALSE(log()[1].passed);
}

TEST_F(CalibrationBox, ARigOfARangeCameraIsAskedForAndLoggedBesideItsFile) {
  write_scan_of_a_ball(at("ball.ply"));
  certify(12.0);
  ASSERT_TRUE(write_file_atomically(at("rig.toml"), kRangeRig).has_value());
  const Outcome passed = play("wait idle\nwait verify-due 10\nclick calibration\nwait verify-artefact\n" +
                              retype("verify-scan", at("ball.ply").string()) +
                              "click verify-now\nwait verify-passed\nwait verified-today\nquit\n");
  ASSERT_EQ(passed.status, 0) << passed.err;
  const auto lines = read_verification_log(at("rig.verified.jsonl"));
  ASSERT_TRUE(lines.has_value());
  ASSERT_THAT(lines->entries, SizeIs(1));
  EXPECT_THAT(lines->entries[0].calibration, HasSubstr("eye:, linear, direction 0 1 0"));
  EXPECT_EQ(read_whole_file(at("rig.toml")).value(), kRangeRig);
}

TEST_F(CalibrationBox, OfTheRigBeforeNothingStaysInIt) {
  write_scan_of_a_ball(at("ball.ply"));
  certify(12.0);
  fs::create_directories(at("other"));
  ASSERT_TRUE(write_file_atomically(at("other/rig.toml"), kRig).has_value());  // not calibrated yet
  const std::string own = at("calibration.json").string();
  const auto change = [](const std::string& uri) {
    return "click close-calibration\nclick device\n" + retype("uri", uri) + "click use-device\nwait idle\n";
  };
  const Outcome outcome =
      play("wait idle\nwait verify-due 10\nclick calibration\nwait verifies " + own +
           "\nclick page-calibrate\nwait keeps-to " + own + "\nclick page-verify\n" +
           // a camera alone: its measurement is no word about that rig, its calibration not that rig's
           change("eye:") + "click calibration\nwait verify-artefact\nexpect verifies nothing\n" +
           retype("verify-scan", at("ball.ply").string()) +
           "click verify-now\nwait verify-passed\nclick page-calibrate\n"
           "wait keeps-to calibration/calibration.json\nclick page-verify\n" +
           // a rig whose calibration is still to be made: to where its file says
           change("rig:" + at("other/rig.toml").string()) +
           "click calibration\nwait verify-artefact\nexpect verifies nothing\nclick page-calibrate\nwait "
           "keeps-to " +
           at("other/calibration.json").string() + "\nclick page-verify\n" +
           change("rig:" + at("rig.toml").string()) + "click calibration\nwait verifies " + own +
           "\nclick close-calibration\nquit\n");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(log(), SizeIs(0));
}

TEST_F(CalibrationBox, ACheckOfTheDayBeforeIsTooOld) {
  VerificationEntry entry;
  entry.when = "2026-01-03T00:00:00Z";
  entry.artefact = "ball 7";
  entry.calibration = "2026-01-02T03:04:05Z";
  entry.passed = true;
  entry.measured = "{}";
  ASSERT_TRUE(append_verification(verification_log_of(at("calibration.json")), entry).has_value());
  const Outcome outcome = play("wait idle\nwait verify-due 10\nquit\n");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(CalibrationBox, PicturesOfABoardBecomeACalibrationOrAreRefusedWithTheReason) {
  const fs::path coarse = at("coarse");
  ASSERT_EQ(run_command({"simulate", "rig", "--poses", "10", "--stops", "3", "--width", "320", "--height",
                         "240", "-o", coarse.string()})
                .status,
            0);
  const fs::path board = at("board");
  fs::create_directories(board);
  for (int k = 0; k < 10; ++k) {
    const std::string name = "pose_0" + std::to_string(k) + ".png";
    fs::copy_file(coarse / name, board / name);
  }
  const fs::path out = at("new.json");
  const Outcome outcome = play(
      "wait idle\nclick calibration\nclick page-calibrate\n" + retype("calibrate-out", out.string()) +
      retype("calibrate-board", "charuco:14x9:4:2.96") +
      // too coarse a camera for what the laser is to measure: refused, and nothing is there to keep
      retype("calibrate-folder", coarse.string()) + "click calibrate-now\nwait calibration-refused 120\n" +
      // the camera alone
      retype("calibrate-folder", board.string()) +
      "click calibrate-now\nwait calibration-whole 120\nclick calibrate-keep\nwait calibration-kept 120\n"
      "click close-calibration\nquit\n");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Result<std::string> text = read_whole_file(out);
  ASSERT_TRUE(text.has_value());
  const Result<RigCalibration> calibration = parse_calibration(*text, out.string());
  ASSERT_TRUE(calibration.has_value());
  EXPECT_FALSE(calibration->has_laser);
  EXPECT_LT(calibration->quality.corner_rms_px, 0.5);
}

TEST_F(CalibrationBox, OfARigIsItsFileAsItStands) {
  const auto file = calibration_file_of("rig:" + at("rig.toml").string());
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->made_at, "2026-01-02T03:04:05Z");
  EXPECT_EQ(file->json, read_whole_file(at("calibration.json")).value());
  EXPECT_FALSE(calibration_file_of("sim:?seed=1").has_value());
  fs::remove(at("calibration.json"));
  EXPECT_FALSE(calibration_file_of("rig:" + at("rig.toml").string()).has_value());
}

TEST_F(CalibrationBox, PicturesAreTakenThroughTheCamera) {
  const fs::path shots = at("shots");
  const fs::path file = at("shots.script");
  std::ofstream(file) << "wait idle\nclick calibration\nclick page-calibrate\n" +
                             retype("calibrate-folder", shots.string()) +
                             "wait camera-picture\nclick shot-laser\npause 0.5\nclick shot-board\n"
                             "wait shot pose_00.png\nclick shot-laser\nwait shot pose_00_laser.png\n"
                             "click shot-stop\nwait shot stage_00.png\nclick close-calibration\nquit\n";
  const Outcome outcome = run_command(
      {"station", "--session", at("session").string(), "--device", "eye:", "--script", file.string()},
      {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/window"}});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name : {"pose_00.png", "pose_00_laser.png", "stage_00.png"}) {
    EXPECT_TRUE(fs::exists(shots / name)) << name;
  }
  const Result<std::string> list = read_whole_file(shots / "calibration.toml");
  ASSERT_TRUE(list.has_value());
  EXPECT_THAT(*list, HasSubstr("pose_00_laser.png"));
  EXPECT_THAT(*list, HasSubstr("stage_00.png"));
  EXPECT_THAT(*list, HasSubstr("camera_serial = \"EYE-1\"")) << "so that no other camera is scanned with it";
}

TEST_F(CalibrationBox, ATurntableAndAMirrorAreCalibratedWithTheTemperature) {
  const auto shoot = [&](const fs::path& shots, const std::string& script) {
    const fs::path file = at("shots.script");
    std::ofstream(file) << "wait idle\nclick calibration\nclick page-calibrate\n" +
                               retype("calibrate-folder", shots.string()) + "wait camera-picture\n" + script +
                               "click close-calibration\nquit\n";
    return run_command(
        {"station", "--session", at("session").string(), "--device", "eye:", "--script", file.string()},
        {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/window"}});
  };
  const auto set_of = [&](const fs::path& shots) {
    const Result<std::string> text = read_whole_file(shots / "calibration.toml");
    return text ? parse_calibration_set(*text, "list") : std::unexpected(text.error());
  };
  const Outcome turned =
      shoot(at("turned"), "click stage-turntable\n" + retype("temperature", "21.5") +
                              "click shot-board\nwait shot pose_00.png\n" + retype("shot-position", "45") +
                              "click shot-stop\nwait shot stage_00.png\n");
  ASSERT_EQ(turned.status, 0) << turned.err;
  const auto table = set_of(at("turned"));
  ASSERT_TRUE(table.has_value()) << table.error().line();
  EXPECT_EQ(table->motion, MotionKind::kTurntable);
  EXPECT_EQ(table->temperature_c, 21.5);
  ASSERT_THAT(table->stops, SizeIs(1));
  EXPECT_NEAR(table->stops[0].position, rad_from_deg(45), 1e-9);
  const Outcome mirrored = shoot(at("mirrored"), "click stage-mirror\n" + retype("shot-position", "3") +
                                                     "click shot-board\nwait shot pose_00.png\n");
  ASSERT_EQ(mirrored.status, 0) << mirrored.err;
  const auto mirror = set_of(at("mirrored"));
  ASSERT_TRUE(mirror.has_value()) << mirror.error().line();
  EXPECT_EQ(mirror->motion, MotionKind::kGalvanometer);
  EXPECT_FALSE(mirror->temperature_c.has_value());
  ASSERT_THAT(mirror->poses, SizeIs(1));
  EXPECT_NEAR(mirror->poses[0].mirror_rad, rad_from_deg(3), 1e-9);
}

TEST_F(CalibrationBox, WhatTheStageDoesIsKnownFromTheRigsFiles) {
  EXPECT_EQ(stage_kind_of("eye:"), MotionKind::kLinear);
  const std::string uri = "rig:" + at("rig.toml").string();
  EXPECT_EQ(stage_kind_of(uri), MotionKind::kLinear);
  std::string turns = kRig;
  for (const char* word : {"from", "to", "step"}) {
    const std::string millimetres = std::string(word) + "_mm";
    turns.replace(turns.find(millimetres), millimetres.size(), std::string(word) + "_deg");
  }
  fs::remove(at("calibration.json"));
  ASSERT_TRUE(write_file_atomically(at("rig.toml"), turns).has_value());
  EXPECT_EQ(stage_kind_of(uri), MotionKind::kTurntable);
  RigCalibration rig = sim::frame_rig({});
  rig.motion.kind = MotionKind::kGalvanometer;
  ASSERT_TRUE(write_file_atomically(at("calibration.json"), calibration_to_json(rig)).has_value());
  EXPECT_EQ(stage_kind_of(uri), MotionKind::kGalvanometer);
}

}  // namespace
}  // namespace dubsar
