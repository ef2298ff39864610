// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Grids of a stage that stood still or moved back: rows that lie over others of the same grid.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/mesh_query.h"
#include "core/random.h"
#include "formats/mesh_formats.h"
#include "sim/scanner.h"
#include "tests/triangulation/support/scans.h"
#include "tests/triangulation/support/simulated_tablet.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stage_passes.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

constexpr double kSpacingMm = 0.1;
constexpr int kCols = 40;
constexpr double kLastRow = 60;

using Places = std::vector<double>;

/// Where the stage stood, in rows of an even grid, from one place to another.
Places run(double from, double to) {
  Places out;
  const double step = from < to ? 1 : -1;
  for (double at = from; step * at <= step * to; at += step) {
    out.push_back(at);
  }
  return out;
}

Places operator+(Places a, const Places& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Places each_twice(const Places& places) {
  Places out;
  for (const double at : places) {
    out.insert(out.end(), {at, at});
  }
  return out;
}

/// Clay with waves; the noise is along the view.
RangeGrid rows_at(const Places& places, double noise_mm) {
  Random random(3);
  RangeGrid grid;
  grid.allocate(static_cast<int>(places.size()), kCols);
  grid.spacing_mm = kSpacingMm;
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const std::size_t i = grid.index(row, col);
      const double x = col * kSpacingMm;
      const double y = places[static_cast<std::size_t>(row)] * kSpacingMm;
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(0.3 * std::sin(2 * x) * std::cos(1.5 * y) + noise_mm * random.normal());
      grid.valid[i] = 1;
    }
  }
  return grid;
}

Mesh stitched(const test::ScanSet& set) {
  JobContext job;
  return stitch(set.placed, {}, job).value_or(Mesh{});
}

/// What is stitched of such a grid is what is stitched of one whose stage never moved back.
void expect_one_whole_sheet(const Places& places, double noise_mm) {
  SCOPED_TRACE(::testing::Message() << places.size() << " rows, noise " << noise_mm << " mm");
  test::ScanSet even;
  even.add(rows_at(run(0, kLastRow), noise_mm), {});
  test::ScanSet set;
  set.add(rows_at(places, noise_mm), {});
  const Mesh mesh = stitched(set);
  ASSERT_FALSE(mesh.faces.empty());
  const MeshReport report = check_mesh(mesh);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_NEAR(report.area_mm2, check_mesh(stitched(even)).area_mm2, 0.03 * report.area_mm2);
  const MeshReport welded = check_mesh(decode_mesh_stl(encode_mesh_stl(mesh), "a.stl", {}).value());
  EXPECT_TRUE(welded.is_manifold());
  for (const std::uint8_t scans : mesh.scans) {
    EXPECT_LE(scans, 1);
  }
  const MeshQuery query(mesh);
  const RangeGrid& grid = set.grids[0];
  std::size_t lost = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    lost += query.closest(grid.point(i), static_cast<float>(kSpacingMm)) ? 0 : 1;
  }
  EXPECT_EQ(lost, 0U);
}

TEST(RepeatedRows, AStageThatMovedBackGivesOneWholeSheet) {
  for (const double noise_mm : {0.0, 0.01}) {
    expect_one_whole_sheet(run(0, 40) + run(25, kLastRow), noise_mm);
    expect_one_whole_sheet(run(0, 40) + run(24.6, kLastRow + 1), noise_mm);
  }
  expect_one_whole_sheet(run(0, 40) + run(25, 40) + run(25, kLastRow), 0.01);
  expect_one_whole_sheet(run(0, 40) + run(39.3, 25) + run(25, kLastRow), 0.01);
  expect_one_whole_sheet(run(0, kLastRow) + run(kLastRow, 0), 0.01);
  expect_one_whole_sheet(run(30, 40) + run(0, kLastRow), 0.01);
}

TEST(RepeatedRows, AStageThatStoodStillGivesOneWholeSheet) {
  for (const double noise_mm : {0.0, 0.01}) {
    expect_one_whole_sheet(run(0, 40) + run(40, kLastRow), noise_mm);
    expect_one_whole_sheet(each_twice(run(0, kLastRow)), noise_mm);
  }
}

TEST(RepeatedRows, WhatIsMeasuredTwiceIsAveraged) {
  const double noise_mm = 0.01;
  const auto squares_off = [&](const Mesh& mesh) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Eigen::Vector3d p = mesh.positions[v].cast<double>();
      if (p.y() > 2.2 && p.y() < 3.8) {
        sum += std::pow(p.z() - 0.3 * std::sin(2 * p.x()) * std::cos(1.5 * p.y()), 2);
        ++count;
      }
    }
    return sum / static_cast<double>(count);
  };
  test::ScanSet even;
  even.add(rows_at(run(0, kLastRow), noise_mm), {});
  test::ScanSet set;
  set.add(rows_at(run(0, 40) + run(20, kLastRow), noise_mm), {});
  EXPECT_LT(squares_off(stitched(set)), 0.7 * squares_off(stitched(even)));
}

TEST(RepeatedRows, APoseIsNoBetterForBeingUsedTwice) {
  test::ScanSet once;
  once.add(rows_at(run(0, kLastRow), 0), {}, 0.2);
  test::ScanSet twice;
  twice.add(rows_at(each_twice(run(0, kLastRow)), 0), {}, 0.2);
  const Mesh a = stitched(once);
  const Mesh b = stitched(twice);
  ASSERT_FALSE(b.sigma_mm.empty());
  EXPECT_NEAR(b.sigma_mm[b.sigma_mm.size() / 2], a.sigma_mm[a.sigma_mm.size() / 2], 0.005);
}

TEST(RepeatedRows, AScanIsNoMoreReliableForItsPasses) {
  const auto mean_reliability = [](const Places& places) {
    test::ScanSet set;
    set.add(rows_at(places, 0), {});
    const Mesh mesh = stitched(set);
    double sum = 0;
    for (const float reliability : mesh.reliability) {
      sum += static_cast<double>(reliability);
    }
    return sum / static_cast<double>(mesh.reliability.size());
  };
  const double once = mean_reliability(run(0, kLastRow));
  ASSERT_LT(once, 0.95);
  EXPECT_NEAR(mean_reliability(each_twice(run(0, kLastRow))), once, 0.02);
}

TEST(RepeatedRows, AScanIsTakenOutWithAllItsPasses) {
  test::ScanSet set;
  set.add(rows_at(run(0, kLastRow), 0.01), {});
  set.add(rows_at(run(0, 40) + run(20, kLastRow), 0.01), {});
  JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed, job));
  EXPECT_EQ(stitcher.overlaps().size(), 1U);
  EXPECT_FALSE(stitcher.add(set.placed[1], job)) << "it is in already";
  EXPECT_TRUE(stitcher.remove(1));
  EXPECT_FALSE(stitcher.remove(1));
  EXPECT_TRUE(stitcher.overlaps().empty());
  test::ScanSet alone;
  alone.add(rows_at(run(0, kLastRow), 0.01), {});
  EXPECT_EQ(stitcher.mesh().positions, stitched(alone).positions);
}

TEST(StagePasses, TheFirstGoesOnBeyondWhatItHas) {
  const auto passes = stage_passes(rows_at(run(0, 9) + run(7, 12) + run(2, 4), 0), kSpacingMm);
  EXPECT_EQ(passes,
            (std::vector<StagePass>{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 14, 15}, {10, 11, 12}, {16, 17, 18}}));
}

TEST(StagePasses, LaserAndCameraStandWhereThePassBegins) {
  RangeGrid grid = rows_at(run(0, 9) + run(7, 12), 0);
  grid.view.laser_mm = Eigen::Vector3d(0, 0, 200);
  grid.view.camera_mm = Eigen::Vector3d(90, 0, 200);
  grid.view.motion_per_row_mm = {0, kSpacingMm, 0};
  const auto passes = stage_passes(grid, kSpacingMm);
  ASSERT_EQ(passes.size(), 2U);
  const RangeGrid part = grid_of_pass(grid, passes[1]);
  EXPECT_EQ(part.rows, 3);
  EXPECT_EQ(part.point(0), grid.point(grid.index(10, 0)));
  EXPECT_TRUE(part.view.laser_mm->isApprox(Eigen::Vector3d(0, 1, 200)));
  EXPECT_TRUE(part.view.camera_mm->isApprox(Eigen::Vector3d(90, 1, 200)));
}

TEST(StagePasses, NoiseOnSteepClayIsNoWayBack) {
  JobContext job;
  const test::SimulatedTablet tablet({10, 9, 6});
  sim::ScannerOptions options;
  options.spacing_mm = 0.05;
  const sim::TriangulationScanner scanner(options);
  const auto grid =
      scanner.scan_grid(tablet.scene(), RigidTransform::from_twist({0.7, 0, 0}, {0, 0, 0}), 1, job);
  ASSERT_TRUE(grid.has_value());
  const auto passes = stage_passes(*grid, grid->spacing_mm);
  ASSERT_EQ(passes.size(), 1U);
  EXPECT_EQ(passes[0].size(), static_cast<std::size_t>(grid->rows));
}

}  // namespace
}  // namespace dubsar
