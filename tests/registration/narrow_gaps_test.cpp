// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Scans with dead columns or dropped profiles, and coarse ones.
#include "registration/narrow_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/support/true_scans.h"
#include "core/grid_geometry.h"
#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

constexpr double kSpacing_mm = 0.15;

enum class Dead { kColumns, kRows };

/// Without the first `width` of each `period` columns or rows.
std::shared_ptr<RangeGrid> without(const RangeGrid& whole, Dead dead, int period, int width) {
  auto out = std::make_shared<RangeGrid>(whole);
  for (std::size_t i = 0; i < out->size(); ++i) {
    if ((dead == Dead::kColumns ? out->col_of(i) : out->row_of(i)) % period < width) {
      out->valid[i] = 0;
    }
  }
  return out;
}

std::size_t missing_in(const RangeGrid& grid) {
  const std::vector<std::uint8_t> gaps = narrow_gaps(grid, grid.valid, {});
  return static_cast<std::size_t>(std::count(gaps.begin(), gaps.end(), std::uint8_t{1}));
}

TEST(NarrowGaps, AreDeadColumnsAndDroppedProfilesWithinTheSurface) {
  const RangeGrid whole = testing::scan_field(testing::bumpy(1), {}, {});
  EXPECT_TRUE(narrow_gaps(whole, whole.valid, {}).empty());
  for (const Dead dead : {Dead::kColumns, Dead::kRows}) {
    const auto grid = without(whole, dead, 10, 2);
    const std::size_t lost = whole.valid_count() - grid->valid_count();
    const std::size_t found = missing_in(*grid);
    EXPECT_GT(static_cast<double>(found), 0.9 * static_cast<double>(lost));
    EXPECT_LE(found, lost);
  }
  EXPECT_EQ(missing_in(*without(whole, Dead::kColumns, 20, 5)), 0U) << "too wide";
}

TEST(NarrowGaps, AreNoDepthStepsNorShortHoles) {
  const auto step = [](double x, double /*y*/) { return x < 0 ? 0.0 : -1.9; };
  RangeGrid stepped = testing::scan_field(step, {}, {});
  RangeGrid holed = testing::scan_field(testing::bumpy(1), {}, {});
  for (std::size_t i = 0; i < stepped.size(); ++i) {
    if (stepped.x[i] > -0.5F && stepped.x[i] < 0.5F) {
      stepped.valid[i] = 0;  // its shadow
    }
    if (holed.col_of(i) % 10 < 2 && holed.row_of(i) % 20 < 15) {
      holed.valid[i] = 0;
    }
  }
  EXPECT_EQ(missing_in(stepped), 0U);
  EXPECT_EQ(missing_in(holed), 0U);
}

TEST(NarrowGaps, LeaveTheCellsBesideThemWithin) {
  const RangeGrid whole = testing::scan_field(testing::bumpy(1), {}, {});
  const auto grid = without(whole, Dead::kColumns, 10, 2);
  const std::vector<std::uint8_t> gaps = narrow_gaps(*grid, grid->valid, {});
  std::vector<std::uint8_t> boundary = grid_geometry(*grid).boundary;
  const std::vector<std::uint8_t> before = boundary;
  bridge_gaps(*grid, gaps, 5.0 * grid->spacing_mm, boundary);
  const std::vector<std::uint8_t> of_whole = grid_geometry(whole).boundary;
  std::size_t bridged = 0;
  for (std::size_t i = 0; i < grid->size(); ++i) {
    EXPECT_TRUE(boundary[i] != 0 || of_whole[i] == 0 || grid->valid[i] == 0) << "an outline became interior";
    bridged += before[i] != 0 && boundary[i] == 0 ? 1 : 0;
  }
  EXPECT_GT(bridged, 2000U);
}

/// Registers the scans; of how many it comes out right, to most_mm.
int right_of(const std::vector<bench::TrueScan>& scans, double most_mm) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    registrar.add(static_cast<int>(k), scans[k].grid, nullptr, job);
  }
  EXPECT_TRUE(registrar.finalize(job));
  const std::vector<ScanPose> poses = registrar.poses();
  int right = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (poses[k].status != PoseStatus::kRegistered || poses[0].status != PoseStatus::kRegistered) {
      ADD_FAILURE() << k << ": " << poses[k].reason;
      continue;
    }
    const bench::PairError error = bench::pair_error(scans, poses[0], poses[k]);
    EXPECT_LT(error.shift_mm, most_mm) << k;
    ++right;
  }
  return right;
}

std::vector<bench::TrueScan> tablet() {
  return bench::true_scans(bench::random_tablet(41, "text", kSpacing_mm),
                           {kSpacing_mm, 0.02, 12, {0, 2, 4}, 41, bench::Pins::kNone, 0});
}

TEST(NarrowGaps, DoNotKeepScansFromTheirPlace) {
  for (const Dead dead : {Dead::kColumns, Dead::kRows}) {
    auto scans = tablet();
    for (bench::TrueScan& scan : scans) {
      scan.grid = without(*scan.grid, dead, 10, 2);
    }
    EXPECT_EQ(right_of(scans, 0.01), 3) << (dead == Dead::kColumns ? "columns" : "rows");
  }
}

std::vector<bench::TrueScan> coarse_tablet(int stride) {
  auto scans = tablet();
  for (bench::TrueScan& scan : scans) {
    scan.grid = std::make_shared<const RangeGrid>(decimated(*scan.grid, stride));
  }
  return scans;
}

TEST(CoarseScans, AreRegisteredAtFourTimesTheSpacing) {
  auto scans = coarse_tablet(4);
  scans.resize(2);
  EXPECT_EQ(right_of(scans, 0.02), 2);
}

TEST(CoarseScans, SayThatTheyAreTooCoarse) {
  const auto scans = coarse_tablet(10);
  JobContext job;
  Registrar registrar;
  registrar.add(0, scans[0].grid, nullptr, job);
  const ScanPose pose = registrar.add(1, scans[1].grid, nullptr, job);
  EXPECT_NE(pose.status, PoseStatus::kRegistered);
  EXPECT_NE(pose.reason.find("too coarse for this object: samples every 1.5 mm"), std::string::npos)
      << pose.reason;
}

}  // namespace
}  // namespace dubsar
