// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that are taken out, or out of their place, and what is left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"
#include "tests/registration/support/pose_error.h"

namespace dubsar {
namespace {

using testing::bumpy;
using ::testing::ElementsAre;
using testing::error_mm;
using testing::FieldScan;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::pose_of;
using testing::scan_field;
using testing::share;

/// Two scans of the left and of the right, 0 and 1, and a third of both, 2.
struct Bridged {
  explicit Bridged(double half_gap_mm) {
    constexpr double kHalfMm = 18;
    const RigidTransform left = pose_of(0, 0, 0, {-kHalfMm - half_gap_mm, 0, 0});
    const RigidTransform right = pose_of(3, -4, 0, {kHalfMm + half_gap_mm, 0, 0});
    truth = left.inverse() * right;
    const auto surface = bumpy(18, 300);
    bridge = share(scan_field(surface, pose_of(-5, 2, 20, {0, 1, 0}), {.seed = 3}));
    registrar.add(0, share(scan_field(surface, left, {.half_mm = kHalfMm, .seed = 1})), nullptr, job);
    registrar.add(1, share(scan_field(surface, right, {.half_mm = kHalfMm, .seed = 2})), nullptr, job);
    EXPECT_THAT(registered(), ElementsAre(0));
    registrar.add(2, bridge, nullptr, job);
    EXPECT_THAT(registered(), ElementsAre(0, 1, 2));
  }
  [[nodiscard]] std::vector<int> registered() const {
    std::vector<int> ids;
    for (const ScanPose& pose : registrar.poses()) {
      if (pose.status == PoseStatus::kRegistered) {
        EXPECT_LT(pose.sigma_mm, 0.05) << pose.id;
        ids.push_back(pose.id);
      }
    }
    return ids;
  }

  RigidTransform truth;  ///< of scan 1, in the frame of scan 0
  std::shared_ptr<const RangeGrid> bridge;
  JobContext job;
  Registrar registrar;
};

TEST(Registrar, WhatOnlyTheScanTakenOutConnectedIsNotRegisteredAnyMore) {
  Bridged scans(0.5);
  ASSERT_TRUE(scans.registrar.remove(2, scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0));
  EXPECT_FALSE(scans.registrar.poses()[1].reason.empty());
  EXPECT_TRUE(scans.registrar.finalize(scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0));

  scans.registrar.add(2, scans.bridge, nullptr, scans.job);
  EXPECT_THAT(scans.registered(), ElementsAre(0, 1, 2));
  const std::vector<ScanPose> poses = scans.registrar.poses();
  EXPECT_LT(error_mm(poses[1], poses[0], scans.truth, {}), 0.02);
}

/// The table, where the first scan was not clipped: what it showed is no measure for the tablets after it.
TEST(Registrar, WhatWasTakenOutIsNoMeasureForTheOthers) {
  FieldScan table;
  table.spacing_mm = 3.0;
  table.half_mm = table.high_x_mm = table.high_y_mm = 400;
  table.low_x_mm = table.low_y_mm = -400;
  FieldScan tablet;
  tablet.seed = 2;
  const auto surface = bumpy(23);
  const RigidTransform truth = pose_of(8, 4, 40, {1, -2, 0});
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(bumpy(99), {}, table)), nullptr, job);
  registrar.add(1, share(scan_field(surface, {}, tablet)), nullptr, job);
  ASSERT_TRUE(registrar.remove(0, job));
  tablet.seed = 9;
  registrar.add(2, share(scan_field(surface, truth, tablet)), nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
  }
}

/// The whole room, beside which a tablet is as small as in a wrong unit: those that were refused for it stood
/// outside for good, until the session was opened anew.
TEST(Registrar, WhatWasRefusedForItsSizeIsTakenInOnceWhatItWasRefusedBesideIsTakenOut) {
  FieldScan room;
  room.spacing_mm = 20.0;
  room.half_mm = room.high_x_mm = room.high_y_mm = 1200;
  room.low_x_mm = room.low_y_mm = -1200;
  const auto surface = bumpy(23);
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(bumpy(99), {}, room)), nullptr, job);
  registrar.add(1, share(scan_field(surface, {}, {.seed = 2})), nullptr, job);
  registrar.add(2, share(scan_field(surface, pose_of(8, 4, 40, {1, -2, 0}), {.seed = 9})), nullptr, job);
  EXPECT_THAT(registrar.poses()[1].reason, HasSubstr("another unit"));
  EXPECT_THAT(registrar.poses()[2].reason, HasSubstr("another unit"));
  ASSERT_TRUE(registrar.remove(0, job));
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
  }
  ASSERT_TRUE(registrar.finalize(job));
  const std::vector<ScanPose> poses = registrar.poses();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_LT(error_mm(poses[1], poses[0], pose_of(8, 4, 40, {1, -2, 0}), {}), 0.05);
}

/// As a file in inches is read where nobody says so.
RangeGrid in_inches(RangeGrid grid) {
  for (auto* values : {&grid.x, &grid.y, &grid.z}) {
    for (float& v : *values) {
      v /= 25.4F;
    }
  }
  grid.spacing_mm /= 25.4;
  return grid;
}

/// The first scan was read in the wrong unit: what comes after it looks 25 times too large.
TEST(Registrar, AScanInAnotherUnitThatWasTakenOutIsNoMeasureForTheOthers) {
  const auto surface = bumpy(23);
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(in_inches(scan_field(surface, pose_of(-5, 2, 20, {0, 1, 0}), {.seed = 3}))), nullptr,
                job);
  registrar.add(1, share(scan_field(surface, {}, {.seed = 2})), nullptr, job);
  registrar.add(2, share(scan_field(surface, pose_of(8, 4, 40, {1, -2, 0}), {.seed = 9})), nullptr, job);
  EXPECT_THAT(registrar.poses()[1].reason + registrar.poses()[2].reason, HasSubstr("inches"));
  ASSERT_TRUE(registrar.remove(0, job));
  registrar.add(3, share(scan_field(surface, pose_of(-6, 3, -50, {2, 1, 0}), {.seed = 5})), nullptr, job);
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
  }
}

TEST(Registrar, WhatOnlyLookedSmallBesideAScanThatWasTakenOutIsNotSaidToBeInAnotherUnit) {
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(bumpy(11), {}, {.seed = 3})), nullptr, job);
  registrar.add(1, share(in_inches(scan_field(bumpy(23), {}, {.seed = 2}))), nullptr, job);
  const ScanPose beside =
      registrar.add(2, share(in_inches(scan_field(bumpy(99), {}, {.seed = 9}))), nullptr, job);
  EXPECT_THAT(beside.reason, HasSubstr("inches"));
  ASSERT_TRUE(registrar.remove(0, job));
  const ScanPose alone = registrar.poses()[1];
  EXPECT_NE(alone.status, PoseStatus::kRegistered);
  EXPECT_THAT(alone.reason, Not(HasSubstr("inches")));
}

TEST(Registrar, ALockedScanThatComesBackIsNoReasonToGoOnWhenStopped) {
  Bridged scans(0.5);
  const RigidTransform before = scans.registrar.poses()[2].model_from_scanner;
  ASSERT_TRUE(scans.registrar.remove(2, scans.job));
  JobContext stopped;
  stopped.cancel();
  scans.registrar.add_at(2, scans.bridge, nullptr, before, true, stopped);
  EXPECT_TRUE(scans.registrar.poses()[2].locked);
  EXPECT_THAT(scans.registered(), ElementsAre(0, 2)) << "what it connects was looked for all the same";
  ASSERT_TRUE(scans.registrar.finalize(scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0, 1, 2));
}

TEST(Registrar, WhatOverlapsStaysWhenTheScanThatJoinedItIsTakenOut) {
  Bridged scans(-2);
  ASSERT_TRUE(scans.registrar.remove(2, scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0, 1));
}

/// The two have a strip in common, and the third held both.
TEST(Registrar, WhatTheScanTakenOutSaidOfTheOthersMakesThemNoSurer) {
  Bridged scans(-2);
  const double with_it_mm = scans.registrar.poses()[1].sigma_mm;
  ASSERT_TRUE(scans.registrar.remove(2, scans.job));
  ASSERT_TRUE(scans.registrar.finalize(scans.job));
  EXPECT_GT(scans.registrar.poses()[1].sigma_mm, 1.5 * with_it_mm);
}

/// The same where the operator's word takes it out of its place.
TEST(Registrar, WhatAScanSaidThatItsHintContradictsMakesTheOthersNoSurer) {
  Bridged scans(-2);
  const double with_it_mm = scans.registrar.poses()[1].sigma_mm;
  PoseHint elsewhere;
  elsewhere.on = 0;
  elsewhere.on_from_scanner = pose_of(0, 90, 0, {40, 40, 0});
  ASSERT_TRUE(scans.registrar.set_hint(2, elsewhere, scans.job));
  ASSERT_TRUE(scans.registrar.finalize(scans.job));
  EXPECT_NE(scans.registrar.poses()[2].status, PoseStatus::kRegistered);
  EXPECT_GT(scans.registrar.poses()[1].sigma_mm, 1.5 * with_it_mm);
}

TEST(Registrar, AScanThatIsLeftAloneIsMeasuredAgainstNothing) {
  const auto surface = bumpy(18);
  Registrar registrar;
  JobContext job;
  registrar.add(3, share(scan_field(surface, {}, {})), nullptr, job);
  const ScanPose beside =
      registrar.add(7, share(scan_field(surface, pose_of(0, 5, 10, {0, 0, 0}), {.seed = 2})), nullptr, job);
  ASSERT_GT(beside.sigma_mm, 0.0);
  ASSERT_GT(beside.overlap, 0.5);
  ASSERT_TRUE(registrar.remove(3, job));
  const ScanPose alone = registrar.poses().front();
  EXPECT_EQ(alone.status, PoseStatus::kRegistered);
  EXPECT_EQ(alone.sigma_mm, 0.0);
  EXPECT_EQ(alone.overlap, 0.0);
  EXPECT_EQ(alone.rms_mm, 0.0);
}

TEST(Registrar, APoseThatLeadsNowhereIsToldAndABetterOneBringsAllBack) {
  Bridged scans(0.5);
  const RigidTransform before = scans.registrar.poses()[2].model_from_scanner;
  EXPECT_FALSE(scans.registrar.set_pose(2, pose_of(0, 90, 0, {40, 40, 0}), false, scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0));
  EXPECT_FALSE(scans.registrar.poses()[1].reason.empty());
  EXPECT_FALSE(scans.registrar.poses()[2].reason.empty());
  EXPECT_TRUE(scans.registrar.set_pose(2, before, false, scans.job));
  EXPECT_THAT(scans.registered(), ElementsAre(0, 1, 2));
}

}  // namespace
}  // namespace dubsar
