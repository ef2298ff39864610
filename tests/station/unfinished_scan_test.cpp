// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/unfinished_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/grid_rows.h"
#include "formats/grid_file.h"
#include "tests/support/seen_syncs.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr int kCols = 7;

/// Rows 0 to `rows` of a scan that is not over.
RangeGrid grown_to(int rows) {
  RangeGrid grid;
  grid.allocate(rows, kCols);
  grid.rgb.resize(3 * grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = i % 5 == 0 ? 0 : 1;
    grid.x[i] = grid.valid[i] != 0 ? 0.1F * static_cast<float>(i) : 0.0F;
    grid.z[i] = grid.valid[i] != 0 ? 3.0F - grid.x[i] : 0.0F;
    grid.rgb[3 * i + 1] = grid.valid[i] != 0 ? static_cast<std::uint8_t>(i) : std::uint8_t{0};
  }
  grid.spacing_mm = 0.1;
  grid.nominal = NominalPose{};
  grid.device = "a scanner";
  grid.timestamp_ns = 77;
  return grid;
}

class Unfinished : public ::testing::Test {
 protected:
  /// A program that ends when `rows` rows are on disk, in two files.
  void break_off_at(int rows, std::optional<Placement> drive = std::nullopt) {
    UnfinishedScan scan(session_, std::move(drive), 0ms);
    for (const int grown : {rows / 2, rows}) {
      const std::size_t before = files();
      while (files() == before) {
        scan.follow(grown_to(grown), 4);
      }
    }
    scan.leave();
  }
  /// With rows.
  [[nodiscard]] std::size_t files() const {
    const std::filesystem::path home = session_ / "grids" / "unfinished";
    if (!std::filesystem::exists(home)) {
      return 0;
    }
    return static_cast<std::size_t>(
        std::ranges::count_if(std::filesystem::recursive_directory_iterator(home), [](const auto& entry) {
          return entry.path().extension() == ".grid" && !entry.path().filename().string().starts_with('.');
        }));
  }
  test::TemporaryFolder folder_;
  std::filesystem::path session_ = folder_.path() / "s";
};

TEST_F(Unfinished, RowsOfAScanThatWasBrokenOffAreThereAgain) {
  Placement drive;
  drive.turntable_rad = 0.5;
  break_off_at(40, drive);
  break_off_at(9);
  const std::vector<LeftScan> left = left_scans(session_);
  ASSERT_THAT(left, SizeIs(2));
  const RangeGrid whole = grown_to(40);
  ASSERT_THAT(left[0].parts, SizeIs(1));
  const RangeGrid& grid = left[0].parts[0];
  EXPECT_EQ(grid.rows, 40);
  EXPECT_TRUE(holds(whole, grid));
  EXPECT_EQ(grid.valid, whole.valid);
  EXPECT_EQ(grid.rgb, whole.rgb);
  EXPECT_EQ(grid.device, "a scanner");
  EXPECT_EQ(grid.timestamp_ns, 77);
  EXPECT_EQ(grid.nominal.value().placement, 4);
  EXPECT_THAT(left[0].unread, IsEmpty());
  EXPECT_EQ(left[0].drive.value().turntable_rad, 0.5);
  EXPECT_FALSE(left[1].drive);
  EXPECT_EQ(left[1].remark, "");
  EXPECT_EQ(left[1].rows(), 9);
  EXPECT_TRUE(holds(whole, left[1].parts.at(0)));
  EXPECT_FALSE(holds(left[1].parts.at(0), grid));
  forget(left[0]);
  EXPECT_THAT(left_scans(session_), SizeIs(1));
  forget(left[1]);
  EXPECT_FALSE(std::filesystem::exists(session_ / "grids" / "unfinished"));
}

TEST_F(Unfinished, ItsFolderIsThereAfterAPowerCut) {
  test::forget_syncs();
  break_off_at(9);
  EXPECT_TRUE(test::was_synced(session_ / "grids")) << "or the name of unfinished/ is lost";
  EXPECT_TRUE(test::was_synced(session_ / "grids" / "unfinished")) << "or that of the scan";
  EXPECT_TRUE(test::was_synced(session_ / "grids" / "unfinished" / "1"));
}

TEST_F(Unfinished, WhatTheDeviceRemarkedIsThereAgain) {
  {
    UnfinishedScan scan(session_, std::nullopt, 0ms);
    scan.remark("the lamp is low");
    while (files() == 0) {
      scan.follow(grown_to(5), 0);
    }
    scan.remark("the lamp is low; the lid was open");  // after its last row
    scan.leave();
  }
  const std::vector<LeftScan> left = left_scans(session_);
  ASSERT_THAT(left, SizeIs(1));
  EXPECT_EQ(left[0].rows(), 5);
  EXPECT_EQ(left[0].remark, "the lamp is low; the lid was open");
}

TEST_F(Unfinished, RowsAroundWhatIsDamagedOrMissingAreParts) {
  const std::filesystem::path first = session_ / "grids" / "unfinished" / "1";
  std::filesystem::create_directories(first);
  const RangeGrid whole = grown_to(50);
  for (const int file : {0, 1, 2, 3, 5}) {
    ASSERT_TRUE(
        write_grid_file(first / ("000" + std::to_string(file) + ".grid"), rows_of(whole, 8 * file, 8)));
  }
  std::filesystem::resize_file(first / "0001.grid", 20);
  std::ofstream(first / "drive.json") << "{";
  std::ofstream(first / "7.grid") << "not ours";
  std::ofstream(session_ / "grids" / "unfinished" / "notes.txt") << "not a scan";
  const std::vector<LeftScan> left = left_scans(session_);
  ASSERT_THAT(left, SizeIs(1));
  ASSERT_THAT(left[0].parts, SizeIs(3));
  EXPECT_EQ(left[0].rows(), 32);
  EXPECT_EQ(left[0].parts[1].x, rows_of(whole, 16, 16).x);
  EXPECT_EQ(left[0].parts[2].x, rows_of(whole, 40, 8).x);
  EXPECT_TRUE(holds(whole, left[0].parts[1]));
  ASSERT_THAT(left[0].unread, SizeIs(3));
  EXPECT_EQ(left[0].unread[0].where, "grids/unfinished/1/0001.grid");
  EXPECT_EQ(left[0].unread[1].line(), "grids/unfinished/1/0004.grid: missing; bring it back from a copy");
  EXPECT_THAT(left[0].unread[2].where, StartsWith("grids/unfinished/1/drive.json"));
  const auto aside = set_aside(left[0]);
  ASSERT_TRUE(aside);
  EXPECT_EQ(*aside, session_ / "grids" / "unfinished" / "1.damaged-1");
  EXPECT_EQ(files(), 6U);
  EXPECT_THAT(left_scans(session_), IsEmpty());
}

TEST_F(Unfinished, AScanThatEndedInGoodOrderLeavesNothing) {
  {
    UnfinishedScan scan(session_, std::nullopt, 0ms);
    scan.follow(grown_to(3), 0);
    while (files() == 0) {
    }
  }
  EXPECT_FALSE(std::filesystem::exists(session_ / "grids" / "unfinished"));
  {
    UnfinishedScan quick(session_, std::nullopt, 10min);
    quick.follow(grown_to(3), 0);
    EXPECT_EQ(files(), 0U) << "a scan that takes no longer than `every` is not written twice";
  }
  EXPECT_THAT(left_scans(session_), IsEmpty());
}

TEST_F(Unfinished, ADiskThatRefusesEndsTheCopyAndNotTheScan) {
  std::ofstream(folder_.path() / "file") << "no folder";
  UnfinishedScan scan(folder_.path() / "file", std::nullopt, 0ms);
  for (int row = 1; row < 200; ++row) {
    scan.follow(grown_to(row), 0);
  }
  EXPECT_THAT(left_scans(folder_.path() / "file"), IsEmpty());
}

TEST(GridRows, AreCutAndPutTogether) {
  const RangeGrid whole = grown_to(11);
  RangeGrid built = rows_of(whole, 0, 4);
  EXPECT_EQ(built.rows, 4);
  ASSERT_TRUE(append_rows(built, rows_of(whole, 4, 7)));
  EXPECT_EQ(built.rows, 11);
  EXPECT_EQ(built.x, whole.x);
  EXPECT_EQ(built.rgb, whole.rgb);
  RangeGrid other = rows_of(whole, 0, 1);
  other.confidence.assign(other.size(), 1.0F);
  EXPECT_FALSE(append_rows(built, other)) << "the others have no confidence";
  other.confidence.clear();
  other.allocate(1, kCols + 1);
  EXPECT_FALSE(append_rows(built, other));
  EXPECT_EQ(built.rows, 11);
}

TEST(GridRows, AreSeenFromWhereTheScannerStoodForTheirFirst) {
  RangeGrid whole = grown_to(11);
  whole.view.camera_mm = Eigen::Vector3d(0, 1, 100);
  whole.view.motion_per_row_mm = Eigen::Vector3d(0, 0.5, 0);
  const RangeGrid below = rows_of(whole, 4, 7);
  EXPECT_EQ(*below.view.camera_mm, Eigen::Vector3d(0, 3, 100));
  EXPECT_FALSE(below.view.laser_mm);
  const Eigen::Vector3d point(1, 2, 3);
  EXPECT_EQ(below.view.to_camera(point, 2), whole.view.to_camera(point, 6));
  RangeGrid built = rows_of(whole, 0, 4);
  ASSERT_TRUE(append_rows(built, below));
  EXPECT_EQ(*built.view.camera_mm, *whole.view.camera_mm);
}

}  // namespace
}  // namespace dubsar
