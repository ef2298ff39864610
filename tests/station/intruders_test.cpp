// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/intruders.h"

#include <gtest/gtest.h>

#include "tests/station/support/bumpy_scans.h"

namespace dubsar {
namespace {

/// Of a surface that stands that much higher, as the motors have it of the very same placement.
StationScan raised_scan(int id, double raised_mm) {
  RangeGrid grid = test::bumpy_scan(0);
  const Eigen::Vector3f up = (-raised_mm * grid.view.direction).cast<float>();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      grid.x[i] += up.x();
      grid.y[i] += up.y();
      grid.z[i] += up.z();
    }
  }
  grid.nominal.emplace();
  return prepare_scan(id, std::move(grid), std::nullopt);
}

ScanPose registered(int id) {
  ScanPose pose;
  pose.id = id;
  pose.status = PoseStatus::kRegistered;
  return pose;
}

// Taken out since the tablet lay badly, which was put right by hand: it says nothing of how it lies now.
TEST(Intruders, AScanThatWasTakenOutIsHeldAgainstNone) {
  constexpr double kRaisedMm = 8;
  IntruderFinder finder;
  finder.add(raised_scan(0, 0));
  finder.add(raised_scan(1, kRaisedMm));
  const std::optional<Intruder> found = finder.look(1, {registered(0), registered(1)});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->id, 1);
  EXPECT_EQ(found->witness, 0);
  EXPECT_FALSE(finder.look(1, {registered(1)}));
  // Nor is it found once more itself.
  finder.add(raised_scan(2, kRaisedMm));
  finder.add(raised_scan(3, 0));
  EXPECT_FALSE(finder.look(3, {registered(0), registered(3)}));
}

}  // namespace
}  // namespace dubsar
