// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What `calibrate --rig` takes a stage for when nobody says it.
#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/calibration_json.h"
#include "sim/frame_rig.h"
#include "station/calibration_run.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

class StageKind : public ::testing::Test {
 protected:
  void write(const std::string& scan) const {
    ASSERT_TRUE(write_file_atomically(rig_,
                                      "name = \"r\"\ncamera = \"eye:\"\nstage = \"none:\"\n"
                                      "calibration = \"calibration.json\"\n[scan]\n" +
                                          scan));
  }
  [[nodiscard]] MotionKind kind() const { return stage_kind_of("rig:" + rig_.string()); }

  test::TemporaryFolder folder_;
  std::filesystem::path rig_ = folder_.path() / "rig.toml";
};

TEST_F(StageKind, WithoutACalibrationItGoesByTheUnitOfTheScan) {
  write("from_mm = 0\nto_mm = 10\nstep_mm = 0.1\n");
  EXPECT_EQ(kind(), MotionKind::kLinear);
  write("from_deg = 0\nto_deg = 10\nstep_deg = 0.1\n");
  EXPECT_EQ(kind(), MotionKind::kTurntable);
}

TEST_F(StageKind, ACalibrationKnowsAMirrorFromATurntable) {
  write("from_deg = 0\nto_deg = 10\nstep_deg = 0.1\n");
  RigCalibration known = sim::frame_rig({});
  known.made_at = "2026-01-02T03:04:05Z";
  known.motion.kind = MotionKind::kGalvanometer;
  ASSERT_TRUE(write_file_atomically(folder_.path() / "calibration.json", calibration_to_json(known)));
  EXPECT_EQ(kind(), MotionKind::kGalvanometer);
  ASSERT_TRUE(write_file_atomically(folder_.path() / "calibration.json", "{"));
  EXPECT_EQ(kind(), MotionKind::kTurntable) << "one that cannot be read tells nothing";
}

TEST_F(StageKind, WhatIsNoRigIsLinear) {
  EXPECT_EQ(stage_kind_of("sim:"), MotionKind::kLinear);
  EXPECT_EQ(stage_kind_of("rig:" + (folder_.path() / "none.toml").string()), MotionKind::kLinear);
}

}  // namespace
}  // namespace dubsar
