// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// A session that begins with a scan that was broken off: a strip of the surface, and then the whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/support/true_scans.h"
#include "core/grid_rows.h"
#include "registration/registrar.h"

namespace dubsar {
namespace {

constexpr double kSpacing_mm = 0.1;

/// The scan's rows until that part of those with something in them.
std::shared_ptr<const RangeGrid> broken_off(const RangeGrid& whole, double part) {
  int first = whole.rows;
  int last = 0;
  for (int row = 0; row < whole.rows; ++row) {
    for (int col = 0; col < whole.cols; ++col) {
      if (whole.is_valid(row, col)) {
        first = std::min(first, row);
        last = row;
      }
    }
  }
  return std::make_shared<const RangeGrid>(
      rows_of(whole, 0, first + static_cast<int>(part * (last - first))));
}

/// Every second row and column.
std::shared_ptr<const RangeGrid> coarser(const RangeGrid& whole) {
  auto out = std::make_shared<RangeGrid>();
  out->allocate(whole.rows / 2, whole.cols / 2);
  out->spacing_mm = 2 * whole.spacing_mm;
  out->view = whole.view;
  out->view.motion_per_row_mm *= 2;
  for (std::size_t i = 0; i < out->size(); ++i) {
    const std::size_t of = whole.index(2 * out->row_of(i), 2 * out->col_of(i));
    out->x[i] = whole.x[of];
    out->y[i] = whole.y[of];
    out->z[i] = whole.z[of];
    out->valid[i] = whole.valid[of];
  }
  return out;
}

struct Case {
  std::uint64_t seed;
  double part;
  bool fits;  ///< it shows enough to find its place
  bool is_coarser = false;
};

class HalfScan : public testing::TestWithParam<Case> {};

TEST_P(HalfScan, ThatASessionBeginsWithSpoilsNothing) {
  const Case& c = GetParam();
  auto scans = bench::true_scans(bench::random_tablet(c.seed, "text", kSpacing_mm),
                                 {kSpacing_mm, 0.02, 12, {0, 2}, c.seed, bench::Pins::kNone, 0});
  scans.insert(scans.begin(), scans.front());
  scans.front().grid = broken_off(*scans.front().grid, c.part);
  if (c.is_coarser) {
    scans.front().grid = coarser(*scans.front().grid);
  }
  ASSERT_GT(scans.front().grid->valid_count(), 100U);
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const ScanPose pose = registrar.add(static_cast<int>(k), scans[k].grid, nullptr, job);
    EXPECT_TRUE(pose.status == PoseStatus::kRegistered || (k == 0 && !c.fits)) << k << pose.reason;
  }
  ASSERT_TRUE(registrar.finalize(job));
  const std::vector<ScanPose> poses = registrar.poses();
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[0].status == PoseStatus::kRegistered, c.fits) << poses[0].reason;
  EXPECT_EQ(poses[0].reason.empty(), c.fits);
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
    if (k == 0 && !c.fits) {
      continue;
    }
    ASSERT_EQ(poses[k].status, PoseStatus::kRegistered) << poses[k].reason;
    const bench::PairError error = bench::pair_error(scans, poses[1], poses[k]);
    EXPECT_LT(error.shift_mm, 0.004) << k;
    EXPECT_LT(error.turn_deg, 0.02) << k;
  }
}
INSTANTIATE_TEST_SUITE_P(Each, HalfScan,
                         testing::Values(Case{2, 0.02, false}, Case{2, 0.05, false}, Case{4, 0.15, true},
                                         Case{2, 0.05, false, true}, Case{4, 0.05, false, true}),
                         [](const auto& one) {
                           return "Of" + std::to_string(std::lround(100 * one.param.part)) +
                                  (one.param.is_coarser ? "Coarser" : "") + "Seed" +
                                  std::to_string(one.param.seed);
                         });

}  // namespace
}  // namespace dubsar
