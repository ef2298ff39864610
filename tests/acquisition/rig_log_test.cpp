// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/rig_log.h"

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>

#include "acquisition/rig_device.h"
#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "sim/frame_rig.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

std::string time_of(double days_ago) {
  const auto then =
      std::chrono::system_clock::now() - std::chrono::seconds(static_cast<long>(86400 * days_ago));
  const std::time_t time = std::chrono::system_clock::to_time_t(then);
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

class LogOfARig : public testing::Test {
 protected:
  void write(const std::string& motion, const std::string& to = "20", const std::string& camera = "eye:R1") {
    const std::string text = "name = \"r\"\ncamera = \"" + camera + "\"\nstage = \"none:\"\n" + motion +
                             "[scan]\nfrom_mm = -20\nto_mm = " + to + "\nstep_mm = 0.025\nspeed_mm_s = 5\n";
    ASSERT_TRUE(write_file_atomically(toml_, text).has_value());
  }
  /// A line as `calibrate --verify` adds it.
  void log(const std::string& when, bool passed = true) const {
    const Result<RigLog> of = rig_log_of(toml_);
    ASSERT_TRUE(of.has_value()) << of.error().line();
    VerificationEntry entry;
    entry.when = when;
    entry.artefact = "bar";
    entry.calibration = of->as_it_stands;
    entry.error_mm = 0.01;
    entry.passed = passed;
    if (!passed) {
      entry.failed = {"flatness error: 90 µm, the limit 60 µm"};
    }
    ASSERT_TRUE(append_verification(of->log, entry).has_value());
  }
  [[nodiscard]] std::string reminder() const {
    return verification_reminder("rig:" + toml_.string()).value_or("none");
  }
  static constexpr const char* kAlong = "[motion]\nkind = \"linear\"\ndirection = [0, 1, 0]\n";
  test::TemporaryFolder folder_;
  std::filesystem::path toml_ = folder_.path() / "head.toml";
};

TEST_F(LogOfARig, RemindsUnlessItWasVerifiedToday) {
  write(kAlong);
  EXPECT_FALSE(verification_reminder("sim:").has_value());
  EXPECT_NE(reminder().find("not been verified"), std::string::npos);
  log(time_of(3.7));
  EXPECT_NE(reminder().find("3 days ago"), std::string::npos);
  log(time_of(1.2));
  EXPECT_NE(reminder().find("1 day ago"), std::string::npos);
  log(time_of(0.4));
  EXPECT_EQ(reminder(), "none");
  log(time_of(0.1), false);
  EXPECT_NE(reminder().find("FAILED its last verification"), std::string::npos);
  EXPECT_NE(reminder().find("flatness"), std::string::npos) << "which limit";
  log("some day");
  EXPECT_NE(reminder().find("nobody knows"), std::string::npos);
}

TEST_F(LogOfARig, AnEarlierScanThatIsMeasuredLaterTakesNoFailureBack) {
  write(kAlong);
  const std::string yesterday = time_of(0.9);
  const std::string today = time_of(0.1);
  log(today, false);
  log(yesterday);
  EXPECT_NE(reminder().find("FAILED its last verification (" + today), std::string::npos) << reminder();
  EXPECT_FALSE(last_verification(toml_).has_value()) << "none that a checklist may show";
  log(today);
  EXPECT_EQ(reminder(), "none") << "the same scan, judged once more";
  log(time_of(-365), false);
  log(today);
  EXPECT_EQ(reminder(), "none") << "a clock that was wrong";
}

TEST_F(LogOfARig, OfARangeCameraLiesBesideItsRigFileAndHoldsWhileCameraAndMotionAreTheSame) {
  write(kAlong);
  const Result<RigLog> of = rig_log_of(toml_);
  ASSERT_TRUE(of.has_value());
  EXPECT_EQ(of->verified, toml_);
  EXPECT_EQ(of->log, folder_.path() / "head.verified.jsonl");
  log(time_of(0.1));
  write(kAlong, "10");
  EXPECT_EQ(reminder(), "none") << "a shorter scan is of the same rig";
  write("[motion]\nkind = \"linear\"\ndirection = [0, 1.002, 0]\n");
  EXPECT_NE(reminder(), "none");
  write(kAlong, "20", "eye:R2");
  EXPECT_NE(reminder(), "none");
  write(kAlong);
  EXPECT_EQ(reminder(), "none");
}

TEST_F(LogOfARig, OfACameraLiesBesideItsCalibration) {
  RigCalibration calibration = sim::frame_rig({});
  calibration.made_at = "2026-01-02T03:04:05Z";
  ASSERT_TRUE(write_file_atomically(folder_.path() / "calibration.json", calibration_to_json(calibration))
                  .has_value());
  ASSERT_TRUE(write_file_atomically(toml_,
                                    "name = \"r\"\ncamera = \"eye:\"\nstage = \"none:\"\ncalibration = "
                                    "\"calibration.json\"\n[scan]\nfrom_mm = 0\nto_mm = 1\nstep_mm = 0.1\n")
                  .has_value());
  const Result<RigLog> of = rig_log_of(toml_);
  ASSERT_TRUE(of.has_value()) << of.error().line();
  EXPECT_EQ(of->verified, folder_.path() / "calibration.json");
  EXPECT_EQ(of->as_it_stands, "2026-01-02T03:04:05Z");
  log(time_of(0.1));
  EXPECT_EQ(reminder(), "none");
  calibration.made_at = "2026-02-02T03:04:05Z";
  ASSERT_TRUE(write_file_atomically(of->verified, calibration_to_json(calibration)).has_value());
  EXPECT_NE(reminder(), "none") << "a new calibration is to be verified anew";
}

TEST_F(LogOfARig, IsNotThereWhereTheFilesCannotBeRead) {
  EXPECT_FALSE(rig_log_of(toml_).has_value());
  ASSERT_TRUE(write_file_atomically(toml_, "name = 1\n").has_value());
  EXPECT_FALSE(rig_log_of(toml_).has_value());
  EXPECT_FALSE(rig_log_of(folder_.path() / "none.json").has_value());
}

}  // namespace
}  // namespace dubsar
