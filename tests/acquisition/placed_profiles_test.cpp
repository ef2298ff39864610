// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/placed_profiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquisition/rig_parts.h"
#include "tests/support/grid_truth.h"

namespace dubsar {
namespace {

constexpr std::int64_t kMs = 1000000;
constexpr double kSpeed = 5;     // mm/s
constexpr double kFrom = -65;    // mm
constexpr double kStep = 0.025;  // mm: a profile every 5 ms

/// A stage that goes from -65 mm on, asked again 4 ms after each answer. Its answers take 1 ms, but `late_ms`
/// where it stands between two positions, and were true when they were asked for.
void ask(PositionTrack& track, double late_from, double late_to, double late_ms) {
  for (std::int64_t asked = 0; asked < 3000 * kMs;) {
    const double there = kFrom + kSpeed * 1e-9 * static_cast<double>(asked);
    const bool late = there > late_from && there < late_to;
    const auto half = late ? static_cast<std::int64_t>(0.5 * late_ms * kMs) : kMs / 2;
    track.add(asked + half, late ? there : there + kSpeed * 1e-9 * static_cast<double>(half), half);
    asked += 2 * half + 4 * kMs;
  }
  track.close();
}

/// All profiles of the stage's way through a scan of 121 rows from -60 mm on, from the camera's `first` on; z
/// is the time, in seconds.
ScanTally scan(PositionTrack& track, test::CollectGrid& sink, int first = 0) {
  RigMotion motion;
  motion.direction = {0, 1, 0};
  PlacedProfiles placed(sink, track, {motion, -60, kStep, 121, "test"});
  ScanInfo info;
  info.cols = 1;
  info.view.motion_per_row_mm = {0, 1, 0};  // made up of the rows' numbers
  EXPECT_TRUE(placed.begin(info));
  bool more = true;
  for (int row = first; row < 590 && more; ++row) {
    const std::vector<float> x{0};
    const std::vector<float> z{0.005F * static_cast<float>(row)};
    Profile profile;
    profile.row = row;
    profile.timestamp_ns = row * 5 * kMs + kMs;
    profile.x = x;
    profile.y = x;
    profile.z = z;
    more = placed.profile(profile);
  }
  placed.flush();
  EXPECT_TRUE(placed.complete());
  return placed.tally();
}

double worst_place_um(const RangeGrid& grid) {
  double worst = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double there = kFrom + kSpeed * (static_cast<double>(grid.z[i]) + 0.001);
    worst =
        grid.valid[i] == 0 ? worst : std::max(worst, 1e3 * std::abs(static_cast<double>(grid.y[i]) - there));
  }
  return worst;
}

TEST(PlacedProfiles, SpacingIsOfTheStepOnASlideAndOfTheClayOnATurntable) {
  PositionTrack track;
  for (const MotionKind kind : {MotionKind::kLinear, MotionKind::kTurntable}) {
    class : public test::CollectGrid {
     public:
      bool begin(const ScanInfo& info) override {
        spacing_mm = info.spacing_mm;
        return test::CollectGrid::begin(info);
      }
      double spacing_mm = -1;
    } sink;
    RigMotion motion;
    motion.kind = kind;
    PlacedProfiles placed(sink, track, {motion, -60, 0.2, 121, "test"});
    ScanInfo info;
    info.cols = 1;
    info.spacing_mm = 0.05;
    EXPECT_TRUE(placed.begin(info));
    placed.flush();
    EXPECT_EQ(sink.spacing_mm, kind == MotionKind::kLinear ? 0.2 : 0.0);
  }
}

TEST(PlacedProfiles, AScanOnATurntableIsSeenFromTheMiddleOfItsTurn) {
  PositionTrack track;
  test::CollectGrid sink;
  RigMotion motion;
  motion.kind = MotionKind::kTurntable;
  motion.direction = {1, 0, 0};
  PlacedProfiles placed(sink, track, {motion, 0.5, 0.01, 101, "test"});
  ScanInfo info;
  info.cols = 1;
  info.view.camera_mm = Eigen::Vector3d(0, 0, 200);
  EXPECT_TRUE(placed.begin(info));
  placed.flush();
  const RigidTransform there = motion.zero_from_camera(1.0);
  EXPECT_LT((sink.grid().view.camera_mm.value() - there * Eigen::Vector3d(0, 0, 200)).norm(), 1e-9);
}

TEST(PlacedProfiles, PutsEachWhereTheStageWas) {
  PositionTrack track;
  ask(track, 0, 0, 0);
  test::CollectGrid sink;
  const ScanTally tally = scan(track, sink);
  const RangeGrid grid = sink.grid();
  EXPECT_EQ(tally.profiles_dropped, 0U);
  EXPECT_NEAR(grid.rows, 121, 1);
  EXPECT_EQ(grid.valid_count(), grid.size());
  EXPECT_LT(worst_place_um(grid), 2);
}

TEST(PlacedProfiles, RowsWhosePlaceIsNotKnownAreLostAndCounted) {
  // At the start of the scan, in its middle and at its end; by itself each answer is four rows off.
  for (const double middle : {-60.0, -58.5, -57.0}) {
    PositionTrack track;
    ask(track, middle - 1.4, middle + 1.4, 40);
    test::CollectGrid sink;
    const ScanTally tally = scan(track, sink);
    const RangeGrid grid = sink.grid();
    EXPECT_LT(worst_place_um(grid), 3 * 1e3 * kSureSteps * kStep) << middle;  // three deviations
    EXPECT_GT(tally.profiles_dropped, 8U) << middle;
    // Every row of the scan came or is counted.
    EXPECT_NEAR(static_cast<double>(grid.valid_count() + tally.profiles_dropped), 121, 2) << middle;
    EXPECT_EQ(tally.profiles_sent, grid.valid_count()) << middle;
    // What came keeps its place among the lost.
    EXPECT_LE(grid.rows, 123) << middle;
  }
}

/// Where it is asked for a row each 5 ms and takes one each 15, as one does that exposes for too long.
TEST(PlacedProfiles, TheHeaderSaysHowFarApartRowsReallyCome) {
  for (const int every : {1, 3}) {
    PositionTrack track;
    ask(track, 0, 0, 0);
    struct : test::CollectGrid {
      bool begin(const ScanInfo& info) override {
        said = info;
        return test::CollectGrid::begin(info);
      }
      ScanInfo said;
    } sink;
    RigMotion motion;
    motion.direction = {0, 1, 0};
    PlacedProfiles placed(sink, track, {motion, -60, kStep, 121, "test", kSpeed});
    ScanInfo info;
    info.cols = 1;
    EXPECT_TRUE(placed.begin(info));
    const std::vector<float> zero{0};
    Profile profile;
    profile.x = profile.y = profile.z = zero;
    bool more = true;
    for (int row = 0; more; ++row) {
      profile.row = row;
      profile.timestamp_ns = row * every * 5 * kMs + kMs;
      more = placed.profile(profile);
    }
    placed.flush();
    EXPECT_TRUE(placed.complete());
    EXPECT_EQ(placed.tally().profiles_dropped, 0U);
    EXPECT_NEAR(sink.said.spacing_mm, every * kStep, 1e-3 * kStep);
    EXPECT_NEAR(sink.said.view.motion_per_row_mm.y(), every * kStep, 1e-3 * kStep);
    EXPECT_NEAR(sink.grid().rows, 121 / every, 1);
    const std::optional<std::string> remark = placed.pitch_remark();
    ASSERT_EQ(remark.has_value(), every > 1);
    if (remark) {
      EXPECT_NE(remark->find("too slow for the stage: rows came 0.075 mm apart, and the step is 0.025 mm"),
                std::string::npos)
          << *remark;
    }
  }
}

/// A camera that takes its time to start, while the stage moves already.
TEST(PlacedProfiles, RowsMissedAtTheStartAreCountedAndTheOthersKeepTheirPlace) {
  for (const double late_to : {0.0, -59.0}) {  // the stage's first answers may be late besides
    PositionTrack track;
    ask(track, -60, late_to, late_to < 0 ? 40 : 1);
    test::CollectGrid sink;
    const ScanTally tally = scan(track, sink, 240);  // at -59 mm, forty rows behind the first
    const RangeGrid grid = sink.grid();
    EXPECT_GE(tally.profiles_dropped, 39U);
    EXPECT_NEAR(static_cast<double>(tally.profiles_sent + tally.profiles_dropped), 121, 1.5);
    EXPECT_NEAR(grid.rows, 121, 1);
    const auto row = static_cast<double>(std::ranges::find(grid.valid, 1) - grid.valid.begin());
    EXPECT_GE(row, 39);
    EXPECT_NEAR(static_cast<double>(grid.y[static_cast<std::size_t>(row)]), -60 + kStep * row, 2 * kStep);
  }
  PositionTrack track;
  ask(track, 0, 0, 0);
  test::CollectGrid sink;
  EXPECT_EQ(scan(track, sink, 150).profiles_dropped, 0U) << "it began before the scan did";
}

/// Rows until it has enough, or `most`; each of the time that `time_of` tells.
template <class TimeOf>
int rows_taken(PlacedProfiles& placed, int most, const TimeOf& time_of) {
  const std::vector<float> zero{0};
  Profile profile;
  profile.x = profile.y = profile.z = zero;
  for (int row = 0; row < most; ++row) {
    profile.row = row;
    profile.timestamp_ns = time_of(row);
    if (!placed.profile(profile)) {
      return row;
    }
  }
  return most;
}

/// Else the laser would be lit, and rows be gathered, for as long as the camera sends any.
TEST(PlacedProfiles, RowsWithoutATimeOfTheirOwnDoNotGoOnForEver) {
  RigMotion motion;
  motion.direction = {0, 1, 0};
  ScanInfo info;
  info.cols = 1;
  for (const bool has_time : {false, true}) {
    PositionTrack track;  // the stage is still under way
    test::CollectGrid sink;
    PlacedProfiles placed(sink, track, {motion, -60, kStep, 121, "test"});
    EXPECT_TRUE(placed.begin(info));
    const int taken = rows_taken(placed, 10000, [&](int) { return has_time ? kMs : 0; });
    EXPECT_EQ(placed.timeless(), !has_time);
    EXPECT_LT(taken, has_time ? 1000 : 1);
    EXPECT_TRUE(placed.single_block());
  }
  // The stage has arrived, and this block began behind that.
  PositionTrack track;
  ask(track, 0, 0, 0);
  test::CollectGrid sink;
  PlacedProfiles placed(sink, track, {motion, -60, kStep, 121, "test"});
  EXPECT_TRUE(placed.begin(info));
  EXPECT_EQ(rows_taken(placed, 10000, [](int) { return 3100 * kMs; }), 0);
}

}  // namespace
}  // namespace dubsar
