// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/sim_station.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "core/units.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

SimStationOptions coarse() {
  SimStationOptions options;
  options.scanner.spacing_mm = 0.3;
  return options;
}

SimTablet rough_tablet() {
  TabletOptions options = small_clean_tablet();
  options.spacing_mm = 0.4;
  return make_or_fail(options);
}

RigidTransform turn_about(const Eigen::Vector3d& axis, double deg) {
  return {Eigen::AngleAxisd(rad_from_deg(deg), axis.normalized()).toRotationMatrix(), {0, 0, 0}};
}

double lowest_mm(const SimStation& station) {
  const RigidTransform pose = station.true_stage_from_tablet();
  double lowest = 1e9;
  for (const Eigen::Vector3f& p : station.tablet().mesh.positions) {
    lowest = std::min(lowest, (pose * p.cast<double>()).z());
  }
  return lowest;
}

TEST(SimStation, HandTurnsComeOutOffByAHandsErrorAndRestOnTheSupport) {
  SimStation station(rough_tablet(), coarse());
  double worst_deg = 0;
  double worst_mm = 0;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d axis = i % 3 == 0 ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0.3, 1, 0.1 * i);
    const RigidTransform turn = turn_about(axis, 90.0 + 7.0 * i);
    const RigidTransform before = station.true_stage_from_tablet();
    ASSERT_TRUE(station.move({0, 0, turn}));
    const RigidTransform after = station.true_stage_from_tablet();
    EXPECT_NEAR(lowest_mm(station), 0.025, 0.03);
    // Against the turn that was asked for ...
    const RigidTransform off{after.rotation * (turn.rotation * before.rotation).transpose(), {0, 0, 0}};
    EXPECT_LE(deg_from_rad(off.angle_rad()), 10.0 + 1e-6);
    EXPECT_LE((after.translation_mm - before.translation_mm).head<2>().norm(), 5.0 + 1e-6);
    // ... and against where motors and asked turns say that it lies.
    const RigidTransform error =
        station.nominal().tablet_from_scanner * station.true_tablet_from_scanner().inverse();
    EXPECT_LE(deg_from_rad(error.angle_rad()), 10.05);
    EXPECT_LE(error.translation_mm.norm(), 5.1);
    EXPECT_EQ(station.nominal().placement, i + 1);
    worst_deg = std::max(worst_deg, deg_from_rad(error.angle_rad()));
    worst_mm = std::max(worst_mm, error.translation_mm.norm());
  }
  EXPECT_GT(worst_deg, 6.0);
  EXPECT_GT(worst_mm, 2.5);
}

/// A tablet larger than the field is pushed along: each time as far off as a hand is, and no farther.
TEST(SimStation, APushedTabletLiesWhereItWasAskedToButForAHandsError) {
  SimStation station(rough_tablet(), coarse());
  int as_a_hand_does = 0;
  for (int i = 0; i < 20; ++i) {
    RigidTransform push;
    push.translation_mm = Eigen::Vector3d(i % 2 == 0 ? 30.0 : -30.0, i % 3 == 0 ? 15.0 : 0.0, 0);
    ASSERT_TRUE(station.move({0, 0, push}));
    const double off_mm =
        (station.true_stage_from_tablet().translation_mm - push.translation_mm).head<2>().norm();
    EXPECT_LE(off_mm, 5.0 + 1e-6);
    as_a_hand_does += off_mm > 0.3 ? 1 : 0;
    const RigidTransform nominal = station.nominal().tablet_from_scanner;
    EXPECT_LT((nominal.translation_mm + push.translation_mm).head<2>().norm(), 1e-6)
        << "the scanner looks beside";
  }
  EXPECT_GT(as_a_hand_does, 15) << "no hand is that exact";
}

/// What stands higher than the scanner's depth is lowered: the scanner looks above its middle from then on.
TEST(SimStation, ALoweredTabletIsLookedAtAboveItsMiddleUntilItIsLaidAgain) {
  SimStation station(rough_tablet(), coarse());
  RigidTransform lowered;
  lowered.translation_mm.z() = -12;
  const RigidTransform foretold = station.nominal_after({0, 0, lowered});
  ASSERT_TRUE(station.move({0, 0, lowered}));
  const auto looks_at_mm = [&] { return station.nominal().tablet_from_scanner.translation_mm; };
  EXPECT_NEAR(looks_at_mm().z(), 12, 1e-9);
  EXPECT_LT((foretold.translation_mm - looks_at_mm()).norm(), 1e-9);
  ASSERT_TRUE(station.move({1.0, 0, std::nullopt}));
  EXPECT_NEAR(looks_at_mm().z(), 12, 1e-9) << "the turntable does not raise it";
  ASSERT_TRUE(station.move({0, 0, RigidTransform{}}));
  EXPECT_NEAR(looks_at_mm().z(), 0, 1e-9);
}

TEST(SimStation, MotorsAreNearlyExactWithinAPlacement) {
  SimStation station(rough_tablet(), coarse());
  const RigidTransform offset =
      station.true_tablet_from_scanner() * station.nominal().tablet_from_scanner.inverse();
  bool differs = false;
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(station.move({0.2 * i, rad_from_deg(2.0 * i), std::nullopt}));
    const RigidTransform now =
        station.true_tablet_from_scanner() * station.nominal().tablet_from_scanner.inverse();
    const RigidTransform drift = now * offset.inverse();
    EXPECT_LT(deg_from_rad(drift.angle_rad()), 0.05);
    EXPECT_LT((now.translation_mm - offset.translation_mm).norm(), 0.1);
    differs = differs || drift.angle_rad() > 1e-6;
    EXPECT_EQ(station.nominal().placement, 0);
  }
  EXPECT_TRUE(differs);
}

TEST(SimStation, NominalAfterForetellsNominal) {
  SimStation station(rough_tablet(), coarse());
  const Placement placement{1.0, 0.5, turn_about({1, 0.2, 0}, 180)};
  const RigidTransform foretold = station.nominal_after(placement);
  ASSERT_TRUE(station.move(placement));
  const RigidTransform nominal = station.nominal().tablet_from_scanner;
  EXPECT_LT((foretold.rotation - nominal.rotation).norm(), 1e-12);
  EXPECT_LT((foretold.translation_mm - nominal.translation_mm).norm(), 1e-12);
}

TEST(SimStation, TheSupportHidesTheUndersideUntilTheTabletIsTurned) {
  SimStation station(rough_tablet(), coarse());
  JobContext job;
  const auto reverse_samples = [&](const Placement& placement) {
    EXPECT_TRUE(station.move(placement));
    const Result<RangeGrid> grid = station.scan_grid(job);
    EXPECT_TRUE(grid);
    const RigidTransform pose = station.true_tablet_from_scanner();
    int count = 0;
    for (std::size_t i = 0; i < grid->size(); ++i) {
      const Eigen::Vector3d p = pose * grid->point(i).cast<double>();
      count += grid->valid[i] != 0 && p.z() < -4.0 && p.head<2>().norm() < 6 ? 1 : 0;
    }
    return count;
  };
  for (const double tilt : {0.0, 30.0, 70.0}) {
    EXPECT_EQ(reverse_samples({1.0, rad_from_deg(tilt), std::nullopt}), 0);
  }
  EXPECT_GT(reverse_samples({0, 0, turn_about({1, 0, 0}, 180)}), 500);
}

TEST(SimStation, TheSupportItselfGivesNoReturn) {
  SimStation station(rough_tablet(), coarse());
  JobContext job;
  for (const double tilt : {0.0, 60.0}) {
    ASSERT_TRUE(station.move({0.3, rad_from_deg(tilt), std::nullopt}));
    const Result<RangeGrid> grid = station.scan_grid(job);
    ASSERT_TRUE(grid);
    const RigidTransform pose = station.true_tablet_from_scanner();
    std::size_t off = 0;
    for (std::size_t i = 0; i < grid->size(); ++i) {
      const auto near = station.query().closest((pose * grid->point(i).cast<double>()).cast<float>(), 0.3F);
      off += grid->valid[i] != 0 && !near ? 1 : 0;
    }
    // Outliers and mixed pixels stay a rare thing.
    EXPECT_LT(static_cast<double>(off), 0.02 * static_cast<double>(grid->valid_count()));
    EXPECT_GT(grid->valid_count(), 2000U);
  }
}

TEST(SimStation, GridsCarryNominalPoseAndPins) {
  SimStationOptions options = coarse();
  options.pins = PinOptions{};
  SimStation station(rough_tablet(), options);
  ASSERT_TRUE(station.move({0.5, 0.3, std::nullopt}));
  JobContext job;
  const RangeGrid header = station.empty_grid();
  const Result<RangeGrid> grid = station.scan_grid(job);
  ASSERT_TRUE(grid);
  EXPECT_EQ(header.rows, grid->rows);
  EXPECT_EQ(header.cols, grid->cols);
  ASSERT_TRUE(grid->nominal);
  EXPECT_EQ(grid->nominal->tablet_from_scanner.row_major(),
            station.nominal().tablet_from_scanner.row_major());
  EXPECT_EQ(grid->pin_tip_diameter_mm, 1.0);
  EXPECT_GE(station.true_tips().size(), 6U);
  EXPECT_EQ(station.true_tips().size(), station.clicked_tips().size());
}

TEST(SimStation, RepeatsToTheByteAndRefusesBadPlacements) {
  SimStation a(rough_tablet(), coarse());
  SimStation b(rough_tablet(), coarse());
  JobContext job;
  const Placement placement{0.4, 0.6, turn_about({0, 1, 0}, 90)};
  ASSERT_TRUE(a.move(placement) && b.move(placement));
  const Result<RangeGrid> grid_a = a.scan_grid(job);
  const Result<RangeGrid> grid_b = b.scan_grid(job);
  ASSERT_TRUE(grid_a && grid_b);
  EXPECT_EQ(grid_a->z, grid_b->z);
  EXPECT_NE(grid_a->z, a.scan_grid(job)->z);  // a second scan has noise of its own

  const RigidTransform before = a.true_tablet_from_scanner();
  RigidTransform skew;
  skew.rotation(0, 1) = 2;
  for (const Placement& bad :
       {Placement{0, 1.5, std::nullopt}, Placement{0, -0.2, std::nullopt}, Placement{NAN, 0, std::nullopt},
        Placement{0, NAN, std::nullopt}, Placement{0, 0, skew}}) {
    const Status moved = a.move(bad);
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().kind, ErrorKind::kUsage);
  }
  EXPECT_EQ(a.true_tablet_from_scanner().row_major(), before.row_major());
}

}  // namespace
}  // namespace dubsar::sim
