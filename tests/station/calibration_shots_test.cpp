// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Pictures of a calibration that are taken through the window, beside those that lie in the folder already.
#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/make_folder.h"
#include "station/calibration_run.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

class CalibrationShots : public ::testing::Test {
 protected:
  [[nodiscard]] std::string take(CalibrationShot shot) const {
    const CalibrationPicture picture{shot, GrayImage(4, 4, 100), "EYE-1", 0};
    const Result<std::string> name =
        add_calibration_shot(pictures_, {"chessboard:9x6:25", MotionKind::kLinear, std::nullopt}, picture);
    return name ? *name : name.error().line();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path pictures_ = folder_.path() / "pictures";
};

/// They were counted from 1, or listed by nobody yet.
TEST_F(CalibrationShots, AreWrittenOverNoPicture) {
  ASSERT_TRUE(make_folder(pictures_));
  for (const char* name : {"pose_00.png", "pose_01_laser.png", "stage_00.png"}) {
    ASSERT_TRUE(write_file_atomically(pictures_ / name, "a person's"));
  }
  EXPECT_EQ(take(CalibrationShot::kBoard), "pose_02.png");
  EXPECT_EQ(take(CalibrationShot::kLaser), "pose_02_laser.png");
  EXPECT_EQ(take(CalibrationShot::kDark), "pose_02_dark.png");
  EXPECT_EQ(take(CalibrationShot::kBoard), "pose_03.png");
  EXPECT_EQ(take(CalibrationShot::kLaser), "pose_03_laser.png");
  EXPECT_EQ(take(CalibrationShot::kLaser), "pose_03_laser.png") << "the same once more";
  EXPECT_EQ(take(CalibrationShot::kStop), "stage_01.png");
  for (const char* name : {"pose_00.png", "pose_01_laser.png", "stage_00.png"}) {
    EXPECT_EQ(read_whole_file(pictures_ / name).value_or(""), "a person's") << name;
  }
}

}  // namespace
}  // namespace dubsar
