// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/poses_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/station/support/bumpy_scans.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What is said of scans that a scanner took from `away_mm`, with translations `factor` times as long as they
/// should be.
std::string fault(double away_mm, double factor, int count = 4) {
  PosesScale scale;
  for (int k = 0; k < count; ++k) {
    RangeGrid grid = test::bumpy_scan(k);
    for (float& z : grid.z) {
      z -= static_cast<float>(away_mm);
    }
    RigidTransform pose = test::bumpy_pose(k);
    pose.translation_mm = factor * (pose * Eigen::Vector3d(0, 0, away_mm));
    scale.add(grid, pose);
  }
  return scale.fault();
}

TEST(PosesScale, TellsTranslationsInAnotherUnit) {
  for (const double away_mm : {100.0, 400.0}) {
    EXPECT_THAT(fault(away_mm, 1), IsEmpty());
    EXPECT_THAT(fault(away_mm, 0.001), HasSubstr("1000 times too small"));
    EXPECT_THAT(fault(away_mm, 1000), HasSubstr("1000 times too large"));
  }
}

TEST(PosesScale, HasNothingToSayWhereNothingIsKnown) {
  EXPECT_THAT(fault(0, 1), IsEmpty()) << "translations of a few millimetres, as they are";
  EXPECT_THAT(fault(400, 0.001, 1), IsEmpty()) << "one scan lies anywhere";
  EXPECT_THAT(fault(400, 0.3), IsEmpty()) << "wrong, and not by a unit";
  EXPECT_THAT(PosesScale().fault(), IsEmpty());
}

}  // namespace
}  // namespace dubsar
