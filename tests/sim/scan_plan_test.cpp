// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scan_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reachable.h"
#include "tests/sim/scenes.h"

namespace dubsar::sim {
namespace {

/// Share of the reachable surface that the views' scans come within one spacing of.
double covered(const TestScene& scene, const std::vector<PlannedView>& views, const ScannerOptions& options) {
  JobContext job;
  ReachOptions sampling;
  sampling.samples = 3000;
  const Result<Reach> reach = reachable_surface(scene.tablet, scene.query, options, sampling, job);
  EXPECT_TRUE(reach);
  std::vector<std::uint8_t> seen(reach->points.size(), 0);
  for (const PlannedView& view : views) {
    const Result<RangeGrid> grid =
        TriangulationScanner(options).scan_grid(scene.scene, view.tablet_from_scanner, 0, job);
    EXPECT_TRUE(grid);
    const RigidTransform scanner_from_tablet = view.tablet_from_scanner.inverse();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Eigen::Vector3d p = scanner_from_tablet * reach->points[i].cast<double>();
      const auto row = std::lround((p.y() - grid->view.laser_mm->y()) / options.spacing_mm);
      for (int c = 0; c < grid->cols && seen[i] == 0; ++c) {
        seen[i] = grid->is_valid(static_cast<int>(row), c) &&
                          (grid->point(grid->index(static_cast<int>(row), c)).cast<double>() - p).norm() <
                              1.5 * options.spacing_mm
                      ? 1
                      : 0;
      }
    }
  }
  double hits = 0;
  double all = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    all += reach->reachable[i];
    hits += reach->reachable[i] != 0 ? seen[i] : 0;
  }
  return hits / all;
}

TEST(ScanPlan, TwelveViewsCoverATablet) {
  TabletOptions clay = small_clean_tablet();
  clay.spacing_mm = 0.25;
  const TestScene scene(make_or_fail(clay));
  ScannerOptions options;
  options.spacing_mm = 0.25;
  EXPECT_GT(covered(scene, plan_views(12, 3), options), 0.99);
  EXPECT_LT(covered(scene, plan_views(1, 3), options), 0.6);
}

TEST(ScanPlan, IsSeededAndNeverRegular) {
  const auto a = plan_views(12, 1);
  const auto b = plan_views(12, 1);
  const auto c = plan_views(12, 2);
  ASSERT_EQ(a.size(), 12U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i].tablet_from_scanner.is_rigid(1e-9));
    EXPECT_EQ(a[i].tablet_from_scanner.row_major(), b[i].tablet_from_scanner.row_major());
    EXPECT_NE(a[i].tablet_from_scanner.row_major(), c[i].tablet_from_scanner.row_major());
    EXPECT_LE(a[i].tablet_from_scanner.translation_mm.norm(), 5.0 + 1e-9);
  }
  EXPECT_TRUE(plan_views(0, 1).empty());
  EXPECT_TRUE(plan_views(-3, 1).empty());
  EXPECT_EQ(plan_views(1, 1).size(), 1U);
  EXPECT_EQ(plan_views(2, 1).size(), 2U);
  EXPECT_EQ(plan_views(40, 1).size(), 40U);
}

}  // namespace
}  // namespace dubsar::sim
