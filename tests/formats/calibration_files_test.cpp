// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <thread>
#include <vector>

#include "formats/artefact_toml.h"
#include "formats/calibration_json.h"
#include "formats/calibration_set.h"
#include "formats/gray_file.h"
#include "formats/rig_toml.h"
#include "formats/verification_log.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

RigCalibration some_rig() {
  RigCalibration rig;
  rig.camera = {2048, 1088, 10240.5, 10241.25, 1030, 537, -0.15, 0.01, 2e-4, -1e-4, 0};
  rig.camera_serial = "40123 \"A\"";
  rig.laser.normal = Eigen::Vector3d(0, 0.8, -0.6);
  rig.laser.distance_mm = -150;
  rig.laser_source_mm = Eigen::Vector3d(0, -100, 20);
  rig.motion.kind = MotionKind::kTurntable;
  rig.motion.direction = Eigen::Vector3d::UnitX();
  rig.motion.axis_point_mm = {0, 8, 268};
  rig.working_distance_mm = 250;
  rig.depth_range_mm = 40;
  rig.made_at = "2026-11-22T06:00:00Z";
  rig.temperature_c = 21.5;
  rig.note = "storeroom";
  rig.quality.board_views = 15;
  rig.quality.volume_sigma_um = 2.5;
  rig.quality.left_out = {"pose_03.png: blurred"};
  return rig;
}

TEST(CalibrationJson, RoundTrip) {
  const RigCalibration rig = some_rig();
  const Result<RigCalibration> back = parse_calibration(calibration_to_json(rig), "calibration.json");
  ASSERT_TRUE(back.has_value()) << back.error().line();
  EXPECT_EQ(calibration_to_json(*back), calibration_to_json(rig));
  EXPECT_EQ(back->camera.fy_px, 10241.25);
  EXPECT_EQ(back->camera_serial, rig.camera_serial);
  EXPECT_EQ(back->motion.axis_point_mm, rig.motion.axis_point_mm);
  EXPECT_EQ(*back->temperature_c, 21.5);
  EXPECT_EQ(back->quality.left_out, rig.quality.left_out);
}

TEST(CalibrationJson, CameraAlone) {
  RigCalibration rig = some_rig();
  rig.has_laser = false;
  rig.has_motion = false;
  const Result<RigCalibration> back = parse_calibration(calibration_to_json(rig), "calibration.json");
  ASSERT_TRUE(back.has_value()) << back.error().line();
  EXPECT_FALSE(back->has_laser);
  EXPECT_FALSE(back->has_motion);
}

TEST(CalibrationJson, RefusesWhatCannotBe) {
  const auto refused = [](const RigCalibration& rig) {
    return !parse_calibration(calibration_to_json(rig), "calibration.json").has_value();
  };
  RigCalibration rig = some_rig();
  rig.laser.normal *= 2;
  EXPECT_TRUE(refused(rig));
  rig = some_rig();
  rig.laser.distance_mm = 0;
  EXPECT_TRUE(refused(rig));
  rig = some_rig();
  rig.camera.k1 = -30;
  EXPECT_TRUE(refused(rig));
  rig = some_rig();
  rig.camera.fx_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(rig));
  EXPECT_FALSE(parse_calibration("{}", "calibration.json").has_value());
  EXPECT_FALSE(parse_calibration("", "calibration.json").has_value());
}

/// "source" may be missing: under a misspelt name it would be, and nobody would know.
TEST(CalibrationJson, RefusesAWordThatItDoesNotKnowWhereverItStands) {
  const std::string text = calibration_to_json(some_rig());
  for (const std::string place : {"camera", "laser", "stage", "quality"}) {
    std::string misspelt = text;
    const std::size_t at = misspelt.find('{', misspelt.find('"' + place + '"'));
    ASSERT_NE(at, std::string::npos) << place;
    misspelt.insert(at + 1, "\"sourse\": 1, ");
    const Result<RigCalibration> refused = parse_calibration(misspelt, "calibration.json");
    ASSERT_FALSE(refused.has_value()) << place;
    EXPECT_NE(refused.error().line().find(place + " has"), std::string::npos) << refused.error().line();
    EXPECT_NE(refused.error().line().find("sourse"), std::string::npos) << refused.error().line();
  }
}

TEST(CalibrationSet, RoundTrip) {
  CalibrationSet set;
  set.board = "charuco:9x7:5:3.7";
  set.motion = MotionKind::kTurntable;
  set.camera_serial = "7\\\"x";
  set.temperature_c = 20;
  set.stripe_per_row = true;
  set.poses = {{"a.png", "a_laser.png", "a_dark.png", 0}, {"b.png", {}, {}, 0}};
  set.stops = {{"s0.png", "board", 0.25}};
  const std::string text = calibration_set_to_toml(set);
  const Result<CalibrationSet> back = parse_calibration_set(text, "calibration.toml");
  ASSERT_TRUE(back.has_value()) << back.error().line() << text;
  EXPECT_EQ(calibration_set_to_toml(*back), text);
  EXPECT_EQ(back->camera_serial, set.camera_serial);
  EXPECT_NEAR(back->stops[0].position, 0.25, 1e-12);
  EXPECT_TRUE(back->stripe_per_row);
}

TEST(CalibrationSet, MayBeginWithTheStage) {
  CalibrationSet set;
  set.board = "chessboard:9x6:25";
  set.motion = MotionKind::kLinear;
  set.stops = {{"stage_00.png", "board", 1.5}};
  const Result<CalibrationSet> back = parse_calibration_set(calibration_set_to_toml(set), "calibration.toml");
  ASSERT_TRUE(back.has_value()) << back.error().line();
  EXPECT_EQ(back->stops.size(), 1U);
}

TEST(CalibrationSet, SaysWhatIsWrong) {
  const auto said = [](const std::string& text) {
    const Result<CalibrationSet> set = parse_calibration_set(text, "calibration.toml");
    return set ? std::string("accepted") : set.error().line();
  };
  EXPECT_NE(said("board = \"b\"\n[[pose]\n").find("line 2"), std::string::npos);
  EXPECT_NE(said("board = \"b\"\n").find("pose"), std::string::npos);
  EXPECT_NE(said("board = \"b\"\nbord = 1\n[[pose]]\nboard = \"a\"\n").find("bord"), std::string::npos);
  EXPECT_NE(said("board = \"b\"\n[[pose]]\nboard = \"../a\"\n").find("inside"), std::string::npos);
  EXPECT_NE(said("board = \"b\"\n[[pose]]\nboard = \"/a\"\n").find("inside"), std::string::npos);
  EXPECT_NE(said("board = \"b\"\nmotion = \"linear\"\n[[pose]]\nboard = \"a\"\n[[stage]]\nboard = "
                 "\"c\"\nposition_deg = 3\n")
                .find("position_mm"),
            std::string::npos);
}

TEST(ArtefactToml, ReadAndRefused) {
  constexpr const char* kBar = R"(
name = "ball bar 7"
certificate = "D-K-1234, 2026-03-01"
plane = true
[limit]
form_um = 20
size_um = 15
spacing_um = 15
flatness_um = 30
[[ball]]
diameter_mm = 12.0003
center_mm = [0, 0, 0]
[[ball]]
diameter_mm = 12.0001
center_mm = [30.4142, 0, 0]
)";
  const Result<Artefact> bar = parse_artefact(kBar, "artefact.toml");
  ASSERT_TRUE(bar.has_value()) << bar.error().line();
  EXPECT_EQ(bar->balls.size(), 2U);
  EXPECT_DOUBLE_EQ(bar->form_limit_mm, 0.02);
  EXPECT_FALSE(parse_artefact(std::string("plane_mm = [0, 4]\n") + kBar, "a").has_value());
  const Result<Artefact> plate = parse_artefact(std::string("plane_mm = [40, 60]\n") + kBar, "a");
  ASSERT_TRUE(plate.has_value()) << plate.error().line();
  EXPECT_TRUE(plate->has_plane);
  EXPECT_EQ(plate->plane_mm, (std::array<double, 2>{60, 40}));
  EXPECT_FALSE(parse_artefact("name = \"x\"\ncertificate = \"y\"\n[limit]\n", "a").has_value());
  std::string near(kBar);
  near.replace(near.find("30.4142"), 7, "3.0");
  EXPECT_FALSE(parse_artefact(near, "a").has_value());
}

TEST(RigToml, ReadAndRefused) {
  constexpr const char* kRig = R"(
name = "rig"
camera = "v4l2:/dev/video0"
stage = "usb_stage:1:2"
calibration = "calibration.json"
camera_settings = [["exposure_us", "1500"]]
[scan]
from_deg = -90
to_deg = 90
step_deg = 0.5
)";
  const Result<RigFile> rig = parse_rig_file(kRig, "rig.toml");
  ASSERT_TRUE(rig.has_value()) << rig.error().line();
  EXPECT_EQ(rig->rows, 361);
  EXPECT_NEAR(rig->step, 0.5 * 3.14159265358979 / 180, 1e-12);
  EXPECT_EQ(rig->camera_settings[0].second, "1500");
  EXPECT_TRUE(rig->ambient);
  const auto refused = [&](const char* what, const char* by) {
    std::string text(kRig);
    text.replace(text.find(what), std::string_view(what).size(), by);
    return !parse_rig_file(text, "rig.toml").has_value();
  };
  EXPECT_TRUE(refused("step_deg = 0.5", "step_deg = 0"));
  EXPECT_TRUE(refused("to_deg = 90", "to_deg = -91"));
  EXPECT_TRUE(refused("to_deg", "to_mm"));
  EXPECT_TRUE(refused("step_deg = 0.5", "step_deg = 0.5\nfrom_mm = -20")) << "it moves and turns";
  EXPECT_TRUE(refused("step_deg = 0.5", "step_deg = 0.5\nspeed_mm_s = 5"));
  EXPECT_TRUE(refused("step_deg = 0.5", "step_deg = 0.5\nlaser_power = 0")) << "nothing would be seen";
  EXPECT_FALSE(refused("step_deg = 0.5", "step_deg = 0.5\nlaser_power = 0.2"));
  EXPECT_TRUE(refused("name", "nam"));
  EXPECT_TRUE(refused("\"1500\"", "1500"));
  EXPECT_TRUE(refused("[scan]", "[scann]"));
  EXPECT_FALSE(rig->region);
  std::string part(kRig);
  part.insert(part.find("[scan]"), "region_px = [0, 400, 2048, 288]\n");
  const Result<RigFile> cut = parse_rig_file(part, "rig.toml");
  ASSERT_TRUE(cut.has_value()) << cut.error().line();
  ASSERT_TRUE(cut->region);
  EXPECT_EQ(cut->region->y, 400);
  EXPECT_EQ(cut->region->height, 288);
  EXPECT_TRUE(refused("[scan]", "region_px = [0, 400, 2048]\n[scan]"));
  EXPECT_TRUE(refused("[scan]", "region_px = [-1, 400, 2048, 288]\n[scan]"));
  EXPECT_TRUE(refused("[scan]", "region_px = [0, 400, 2048, 0]\n[scan]"));
  // A stage that moves through: nothing stands still for an ambient frame.
  const std::string through = std::string(kRig) + "continuous = true\n";
  const Result<RigFile> moving = parse_rig_file(through, "rig.toml");
  ASSERT_TRUE(moving.has_value()) << moving.error().line();
  EXPECT_TRUE(moving->continuous);
  EXPECT_FALSE(moving->ambient);
  EXPECT_FALSE(parse_rig_file(through + "ambient = true\n", "rig.toml").has_value());
  // A range camera has a motion and no calibration; never both, never neither.
  std::string range(kRig);
  range.replace(range.find("calibration = \"calibration.json\"\n"), 33, "");
  EXPECT_FALSE(parse_rig_file(range, "rig.toml").has_value());
  const std::string motion = "[motion]\nkind = \"turntable\"\ndirection = [0, 2, 0]\npoint_mm = [0, 0, 9]\n";
  const Result<RigFile> carried = parse_rig_file(range + motion, "rig.toml");
  ASSERT_TRUE(carried.has_value()) << carried.error().line();
  EXPECT_TRUE(carried->calibration.empty());
  EXPECT_EQ(carried->motion->kind, MotionKind::kTurntable);
  EXPECT_NEAR(carried->motion->direction.y(), 1, 1e-12);
  EXPECT_FALSE(parse_rig_file(kRig + motion, "rig.toml").has_value());
  EXPECT_FALSE(
      parse_rig_file(range + "[motion]\nkind = \"linear\"\ndirection = [0, 0, 0]\n", "rig.toml").has_value());
}

TEST(VerificationLog, KeepsEveryLineAndSurvivesADamagedOne) {
  const test::TemporaryFolder folder;
  const auto path = verification_log_of(folder.path() / "calibration.json");
  EXPECT_EQ(path.filename(), "calibration.verified.jsonl");
  VerificationEntry entry{"2026-11-22T06:00:00Z", "bar", "c", "2026-11-01T00:00:00Z", 0.012, true, {}, "{}"};
  ASSERT_TRUE(append_verification(path, entry).has_value());
  entry.passed = false;
  entry.failed = {"flatness"};
  ASSERT_TRUE(append_verification(path, entry).has_value());
  const Result<VerificationLog> log = read_verification_log(path);
  ASSERT_TRUE(log.has_value());
  ASSERT_EQ(log->entries.size(), 2U);
  EXPECT_EQ(log->entries[1].failed, std::vector<std::string>{"flatness"});
  const VerificationLog torn = parse_verification_log("{\"when\": 3}\nrubbish\n\n");
  EXPECT_EQ(torn.damaged, 2U);
  const VerificationLog others = parse_verification_log("[]\n \t7\n\"when\"\n]\n");
  EXPECT_EQ(others.damaged, 4U);
  // As an editor may leave it: a byte order mark, blanks before the line.
  const std::string line =
      R"({"when":"w","artefact":"a","certificate":"c","calibration":"m","error_mm":0.1,"passed":true,"failed":[]})";
  const VerificationLog edited = parse_verification_log("\xEF\xBB\xBF" + line + "\n  \t" + line + "\r\n");
  EXPECT_EQ(edited.entries.size(), 2U);
  EXPECT_EQ(edited.damaged, 0U);
  EXPECT_TRUE(torn.entries.empty());
  EXPECT_TRUE(read_verification_log(folder.path() / "none")->entries.empty());
}

TEST(VerificationLog, LosesNoneOfThoseThatAreAddedAtTheSameMoment) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "calibration.verified.jsonl";
  constexpr int kWriters = 4;
  constexpr int kEach = 20;
  {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < kWriters; ++writer) {
      writers.emplace_back([&path, writer] {
        for (int k = 0; k < kEach; ++k) {
          const std::string name = std::to_string(writer) + "/" + std::to_string(k);
          EXPECT_TRUE(append_verification(path, {"w", name, "c", "m", 0.01, true, {}, "{}"}).has_value());
        }
      });
    }
  }
  const Result<VerificationLog> log = read_verification_log(path);
  ASSERT_TRUE(log.has_value());
  EXPECT_EQ(log->damaged, 0U);
  std::set<std::string> names;
  for (const VerificationEntry& entry : log->entries) {
    names.insert(entry.artefact);
  }
  EXPECT_EQ(log->entries.size(), std::size_t{kWriters * kEach});
  EXPECT_EQ(names.size(), std::size_t{kWriters * kEach});
}

TEST(GrayFile, PngAndPgm) {
  const test::TemporaryFolder folder;
  GrayImage image(37, 21);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>(i * 7);
  }
  ASSERT_TRUE(write_gray_png(image, folder.path() / "a.png").has_value());
  const Result<GrayImage> back = read_gray(folder.path() / "a.png");
  ASSERT_TRUE(back.has_value()) << back.error().line();
  EXPECT_EQ(back->pixels, image.pixels);
  std::string pgm = "P5\n# a comment\n37 21\n255\n";
  pgm.append(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size());
  ASSERT_TRUE(parse_gray(pgm, "a.pgm").has_value());
  EXPECT_EQ(parse_gray(pgm, "a.pgm")->pixels, image.pixels);
  EXPECT_FALSE(parse_gray(pgm.substr(0, pgm.size() - 1), "a.pgm").has_value());
  const std::string windows = "P5\r\n# a comment\r\n37 21\r\n255\r\n" + pgm.substr(pgm.find("255\n") + 4);
  EXPECT_EQ(parse_gray(windows, "a.pgm").value().pixels, image.pixels) << "shifted by a byte";
  const std::string begins_so = "P5 2 1 255\r\n\x05";  // its first pixel is a line feed
  EXPECT_EQ(parse_gray(begins_so, "a.pgm").value().pixels, (std::vector<std::uint8_t>{10, 5}));
  EXPECT_FALSE(parse_gray("P5 99999 99999 255\n", "a.pgm").has_value());
  EXPECT_FALSE(parse_gray("GIF89a", "a.gif").has_value());
  EXPECT_FALSE(parse_gray("\xff\xd8\xff\xe0 rubbish", "a.jpg").has_value());
  EXPECT_FALSE(parse_gray("\x89PNG\r\n\x1a\n rubbish", "a.png").has_value());
}

// Of linear light by its gAMA, as ImageMagick writes LinearGray: 64 of 255 became 136.
TEST(GrayFile, APngIsReadAsItsNumbersStandWhateverLightTheyAreOf) {
  constexpr char kFourByOne[] =
      "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x04\x00\x00"
      "\x00\x01\x08\x00\x00\x00\x00\xdc\x57\x50\x11\x00\x00\x00\x04\x67\x41\x4d\x41\x00\x01\x86"
      "\xa0\x31\xe8\x96\x5f\x00\x00\x00\x0d\x49\x44\x41\x54\x78\x9c\x63\xe0\x72\x68\x38\x01\x00"
      "\x02\xb5\x01\x93\xa1\x0b\xbc\xc4\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";
  const Result<GrayImage> read = parse_gray({kFourByOne, sizeof kFourByOne - 1}, "a.png");
  ASSERT_TRUE(read.has_value()) << read.error().line();
  EXPECT_EQ(read->pixels, (std::vector<std::uint8_t>{10, 64, 128, 200}));
}

// Read as 8 bits it would go through a curve: 64 of 255 became 136.
TEST(GrayFile, APngOfSixteenBitsIsRefused) {
  constexpr char kOneByOne[] =
      "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x01\x00\x00"
      "\x00\x01\x10\x00\x00\x00\x00\x6a\xee\x47\x16\x00\x00\x00\x0b\x49\x44\x41\x54\x78\x9c\x63"
      "\x70\x70\x00\x00\x00\xc3\x00\x81\xdf\xdf\x82\xe6\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42"
      "\x60\x82";
  const Result<GrayImage> read = parse_gray({kOneByOne, sizeof kOneByOne - 1}, "a.png");
  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(read.error().line(),
            "a.png: the picture has 16 bits a colour; give it with 8, as the camera's full range");
}

}  // namespace
}  // namespace dubsar
