// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/range_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "build_paths.h"
#include "core/units.h"
#include "formats/poses_json.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wrong_spacing.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path kLibraries = fs::path(DUBSAR_BINARY_DIR) / "lib/dubsar";

class RangeSourceTest : public testing::Test {
 protected:
  RangeSource open(const std::string& uri) {
    Result<RangeSource> source = RangeSource::open(uri, registry_);
    EXPECT_TRUE(source) << source.error().line();
    return std::move(*source);
  }
  DriverRegistry registry_{{kLibraries / "drivers", kLibraries / "test_drivers/good"}};
  JobContext job_;
};

TEST_F(RangeSourceTest, GivesGridsRowByRowUntilExhausted) {
  RangeSource source = open("odd:1");
  std::vector<int> rows;
  for (int scan = 0; scan < 2; ++scan) {
    const auto grid = source.next(
        [&](const RangeGrid& so_far, int row) {
          EXPECT_EQ(so_far.rows, row + 1);
          EXPECT_EQ(so_far.x.size(), static_cast<std::size_t>(so_far.rows * so_far.cols));
          EXPECT_EQ(so_far.valid.size(), so_far.x.size());
          rows.push_back(row);
        },
        job_);
    ASSERT_TRUE(grid) << grid.error().line();
    ASSERT_TRUE(*grid);
    EXPECT_EQ((*grid)->rows, 6);
    EXPECT_EQ((*grid)->valid_count(), 48U);
    EXPECT_NEAR((*grid)->spacing_mm, 0.5, 1e-6) << "the device tells none: from the samples";
    EXPECT_EQ((*grid)->device, "odd 0815");
    EXPECT_TRUE((*grid)->nominal);
  }
  EXPECT_THAT(rows, ElementsAre(0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5));
  EXPECT_FALSE(source.next({}, job_).value());
}

TEST_F(RangeSourceTest, OddProfilesAreMadeGoodAndCounted) {
  RangeSource source = open("odd:1?mode=ragged");
  const RangeGrid grid = source.next({}, job_).value().value();
  EXPECT_EQ(grid.rows, 5) << "the lost row is there, empty; the repeated one is not";
  EXPECT_EQ(grid.size(), 40U);
  EXPECT_TRUE(grid.is_valid(0, 0));
  EXPECT_FALSE(grid.is_valid(0, 2));
  EXPECT_TRUE(grid.is_valid(1, 4));
  EXPECT_FALSE(grid.is_valid(1, 5)) << "a short profile";
  EXPECT_FALSE(grid.is_valid(2, 0)) << "NaN";
  EXPECT_FALSE(grid.is_valid(2, 1)) << "infinite";
  EXPECT_FALSE(grid.is_valid(2, 3)) << "farther than a kilometre";
  EXPECT_TRUE(grid.is_valid(2, 4));
  for (int col = 0; col < grid.cols; ++col) {
    EXPECT_FALSE(grid.is_valid(3, col));
  }
  EXPECT_FLOAT_EQ(grid.y[grid.index(4, 0)], 2.0F);
  const ScanRecord& record = source.record();
  EXPECT_EQ(record.faults.odd_lengths, 1U);
  EXPECT_EQ(record.faults.bad_samples, 3U);
  EXPECT_EQ(record.faults.rows_lost, 1U);
  EXPECT_EQ(record.faults.rows_repeated, 1U);
  EXPECT_EQ(record.tally.profiles_dropped, 1U);
  EXPECT_EQ(losses_of(record),
            "not all of it came as it was measured: rows lost: 1, rows that came twice: 1, rows of another "
            "length: 1, samples that are no places: 3");
  EXPECT_EQ(losses_of({}), "");
}

TEST(GridBuilder, AGapThatNoMemoryHoldsIsANumberGoneWrong) {
  ScanInfo info;
  info.cols = 1 << 20;
  GridBuilder builder(info);
  const std::vector<float> some(8, 1.0F);
  Profile profile;
  profile.row = 9000;
  profile.x = profile.y = profile.z = some;
  ASSERT_TRUE(builder.append(profile));
  EXPECT_EQ(builder.grid().rows, 1);
  EXPECT_EQ(builder.faults().rows_lost, 9000U);
}

/// A scan of an hour after the machine was switched on was dated one in the morning of 1970-01-01.
TEST(GridBuilder, ATimeSinceTheMachineBeganIsNoDate) {
  ScanInfo info;
  info.cols = 2;
  GridBuilder builder(info);
  const std::vector<float> line{1, 2};
  Profile profile;
  profile.x = profile.y = profile.z = line;
  profile.timestamp_ns = 3'600'000'000'000;
  ASSERT_TRUE(builder.append(profile));
  EXPECT_EQ(builder.grid().timestamp_ns, 0);
  profile.row = 1;
  profile.timestamp_ns = 1'735'689'600'000'000'000;
  ASSERT_TRUE(builder.append(profile));
  EXPECT_EQ(builder.grid().timestamp_ns, profile.timestamp_ns);
}

TEST_F(RangeSourceTest, AFailureInMidScanKeepsTheRowsAndTheNextScanRuns) {
  RangeSource source = open("odd:1?mode=fail");
  const auto failed = source.next({}, job_);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::kDevice);
  const std::optional<RangeGrid> half = source.take_partial();
  ASSERT_TRUE(half);
  EXPECT_EQ(half->rows, 3);
  EXPECT_EQ(half->valid_count(), 24U);
  EXPECT_FALSE(source.take_partial());
  EXPECT_EQ(source.next({}, job_).value()->rows, 6);
  EXPECT_FALSE(source.take_partial());
}

TEST_F(RangeSourceTest, WhatADeviceRemarksIsThereWhileItStillScans) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "a.ply") << test::ply_of_wrong_spacing();
  RangeSource source = open("replay:" + folder.path().string());
  std::vector<std::size_t> remarks;
  ASSERT_TRUE(
      source.next([&](const RangeGrid&, int) { remarks.push_back(source.record().remarks.size()); }, job_));
  EXPECT_THAT(remarks, testing::Each(1U));
  EXPECT_FALSE(remarks.empty());
}

TEST_F(RangeSourceTest, ACancelledJobStopsAnEndlessScan) {
  RangeSource source = open("odd:1?mode=forever");
  const auto stopped =
      source.next([&](const RangeGrid&, int row) { row == 20 ? job_.cancel() : void(); }, job_);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(source.take_partial()->rows, 21);
}

TEST_F(RangeSourceTest, AHaltKeepsTheRowsAndNothingMovesUntilItIsOpenedAnew) {
  RangeSource source = open("odd:1?mode=forever");
  const auto halted =
      source.next([&](const RangeGrid&, int row) { row == 20 ? source.halt() : void(); }, job_);
  ASSERT_FALSE(halted);
  EXPECT_EQ(halted.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(halted.error().line(), HasSubstr("emergency stop was pressed"));
  EXPECT_EQ(source.take_partial()->rows, 21);
  EXPECT_THAT(source.next({}, job_).error().line(), HasSubstr("emergency stop was pressed"));
  EXPECT_THAT(source.place(Placement{}, job_).error().line(), HasSubstr("emergency stop was pressed"));
  EXPECT_TRUE(open("odd:1").next({}, job_));
}

/// A camera has not answered to its stop before its scan is over.
TEST_F(RangeSourceTest, AStopThatIsNotObeyedAtTheScansEndIsTold) {
  for (const bool halted : {false, true}) {
    JobContext job;
    RangeSource source = open("odd:1?mode=burns");
    const auto stopped = source.next(
        [&](const RangeGrid&, int row) { row < 20 ? void()
                                         : halted ? job.halt()
                                                  : job.cancel(); }, job);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kDevice);
    EXPECT_THAT(stopped.error().line(),
                HasSubstr("laser and motors may still be on: the camera does not end"));
    EXPECT_EQ(source.take_partial()->rows, 21);
  }
}

TEST_F(RangeSourceTest, AScanWithoutProfilesIsAnError) {
  RangeSource source = open("odd:1?mode=empty");
  EXPECT_THAT(source.next({}, job_).error().line(), HasSubstr("without a single profile"));
}

TEST_F(RangeSourceTest, PointsWithoutAnOrderAreResampledAndShownRowByRow) {
  RangeSource source = open("odd:1?mode=points");
  int rows = 0;
  const RangeGrid grid = source.next([&](const RangeGrid&, int) { ++rows; }, job_).value().value();
  EXPECT_TRUE(source.record().resampled);
  EXPECT_EQ(grid.valid_count(), 48U);
  EXPECT_EQ(rows, grid.rows);
  EXPECT_EQ(grid.source, "odd scan");
  EXPECT_GT(grid.spacing_mm, 0.3);
}

TEST_F(RangeSourceTest, TheSimulatedScannerStreamsAndKeepsTheTruthToFiles) {
  test::TemporaryFolder truth;
  RangeSource source =
      open("sim:?seed=4&size=24x20x10&spacing=0.4&mesh_spacing=0.5&noise=0.01&pins=1&truth=" +
           truth.path().string());
  ASSERT_TRUE(source.capabilities().rig);
  EXPECT_TRUE(source.capabilities().can_place);
  EXPECT_FALSE(source.capabilities().finite);
  EXPECT_DOUBLE_EQ(source.capabilities().rig->spacing_mm, 0.4);
  int rows = 0;
  const RangeGrid first = source.next([&](const RangeGrid&, int) { ++rows; }, job_).value().value();
  EXPECT_EQ(rows, first.rows);
  EXPECT_GT(first.valid_count(), 1000U);
  EXPECT_EQ(first.source, "scan_000");
  EXPECT_GT(first.pin_tip_diameter_mm, 0);
  ASSERT_TRUE(first.nominal);

  Placement placement;
  placement.turntable_rad = rad_from_deg(90);
  placement.tilt_rad = rad_from_deg(30);
  placement.hand_turn = RigidTransform::from_twist({0, rad_from_deg(180), 0}, {0, 0, 0});
  ASSERT_TRUE(source.place(placement, job_));
  const RangeGrid second = source.next({}, job_).value().value();
  EXPECT_GT(second.nominal->placement, first.nominal->placement);
  EXPECT_FALSE(source.place({.turntable_rad = 0, .tilt_rad = 3, .hand_turn = {}}, job_));

  const std::vector<ScanPose> poses = read_poses(truth.path() / "truth_poses.json").value();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].file, "scan_001");
  const RigidTransform off = second.nominal->tablet_from_scanner.inverse() * poses[1].model_from_scanner;
  EXPECT_GT(off.translation_mm.norm(), 1e-3) << "a hand turn never comes out exactly";
  EXPECT_LT(off.angle_rad(), rad_from_deg(25));
  for (const char* name : {"tablet.ply", "truth.json", "truth_pins.json", "pins.json"}) {
    EXPECT_TRUE(fs::exists(truth.path() / name)) << name;
  }

  // The same seed gives the same samples; the written surface can be scanned in the tablet's stead.
  RangeSource again = open("sim:?seed=4&size=24x20x10&spacing=0.4&mesh_spacing=0.5&noise=0.01&pins=1");
  EXPECT_EQ(again.next({}, job_).value()->z, first.z);
  RangeSource from_file = open("sim:?spacing=0.5&tablet=" + (truth.path() / "tablet.ply").string());
  EXPECT_GT(from_file.next({}, job_).value()->valid_count(), 500U);
}

TEST_F(RangeSourceTest, SimOptionsOutOfRangeAreRefused) {
  for (const char* uri : {"sim:?size=50x40", "sim:?size=50x40x400", "sim:?spacing=0", "sim:?noise=nan",
                          "sim:?seed=1.5", "sim:?pins=2", "sim:?tablet=/nowhere.ply", "sim:here"}) {
    const auto source = RangeSource::open(uri, registry_);
    ASSERT_FALSE(source) << uri;
    EXPECT_EQ(exit_status(source.error().kind), 2) << source.error().line();
  }
}

TEST_F(RangeSourceTest, ReplaysTheRealBunny) {
  const fs::path data = test::real_data();
  if (!fs::exists(data / "stanford_bunny")) {
    GTEST_SKIP() << "no real scans at " << data;
  }
  RangeSource source = open("replay:" + (data / "stanford_bunny").string() + "?unit=m");
  EXPECT_EQ(source.capabilities().scan_count, 10);
  std::vector<std::string> names;
  for (;;) {
    const auto grid = source.next({}, job_);
    ASSERT_TRUE(grid) << grid.error().line();
    if (!*grid) {
      break;
    }
    names.push_back((*grid)->source);
    EXPECT_GT((*grid)->valid_count(), 20000U);
    EXPECT_GT((*grid)->spacing_mm, 0.1);
    EXPECT_LT((*grid)->spacing_mm, 2.0);
  }
  EXPECT_EQ(names.size(), 10U);
  EXPECT_TRUE(std::ranges::is_sorted(names));
}

}  // namespace
}  // namespace dubsar
