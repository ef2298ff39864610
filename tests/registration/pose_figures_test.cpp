// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is told beside a pose: how much of the scan others show too, and how far its samples lie off them.
#include <gtest/gtest.h>

#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"
#include "tests/registration/support/pose_error.h"

namespace dubsar {
namespace {

using testing::FieldScan;
using testing::pose_of;
using testing::scan_field;
using testing::share;

/// The part of one surface from `low_x_mm` to `high_x_mm` (and 50 mm across), where it lies.
void add_part(Registrar& registrar, int id, double low_x_mm, double high_x_mm) {
  const RigidTransform pose = pose_of(3.0 * id, -2.0 * id, 5.0 * id, {1.0 * id, 0, 0});
  FieldScan scan;
  scan.low_x_mm = low_x_mm;
  scan.high_x_mm = high_x_mm;
  scan.seed = 20 + static_cast<std::uint64_t>(id);
  JobContext job;
  registrar.add_at(id, share(scan_field(testing::bumpy(13, 120), pose, scan)), nullptr, pose, false, job);
}

/// The half lies on the whole with all but its rims and what is too steep; of the whole less than a half lies
/// on the half.
TEST(PoseFigures, OverlapIsOfTheSmallerScanAndRmsOfTheOrderOfTheNoise) {
  Registrar registrar;
  add_part(registrar, 0, -25, 25);
  add_part(registrar, 1, -25, -3);
  JobContext job;
  ASSERT_TRUE(registrar.finalize(job));
  for (const ScanPose& pose : registrar.poses()) {
    ASSERT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    EXPECT_GT(pose.overlap, 0.65) << pose.id;
    EXPECT_LE(pose.overlap, 1.0) << pose.id;
    // Both have 0.01 mm of noise along the view, and samples 0.4 mm apart on bumps: no less than a half of
    // that, and no sample counts that is off by more than three sigmas of 0.08 mm and the noise.
    EXPECT_GT(pose.rms_mm, 0.005) << pose.id;
    EXPECT_LT(pose.rms_mm, 0.1) << pose.id;
  }
}

}  // namespace
}  // namespace dubsar
