// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitcher.h"

#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/mesh_query.h"
#include "core/random.h"
#include "tests/triangulation/support/ball_scans.h"
#include "triangulation/mesh_check.h"

namespace dubsar {
namespace {

using test::ball;
using test::ball_grid;
using test::expect_same;
using test::kRadius;
using test::stitched;
using test::view_from;

double rms_off_ball(const Mesh& mesh) {
  double sum = 0;
  for (const auto& p : mesh.positions) {
    const double d = p.cast<double>().norm() - kRadius;
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(mesh.positions.size()));
}

void expect_a_ball(const MeshReport& report) {
  EXPECT_TRUE(report.is_closed());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_NEAR(report.area_mm2, 4 * kPi * kRadius * kRadius, 0.02 * 4 * kPi * kRadius * kRadius);
}

TEST(Stitcher, GridsWhoseSpacingNobodyToldAreStitchedToo) {
  test::ScanSet set = ball();
  for (RangeGrid& grid : set.grids) {
    grid.spacing_mm = 0;
  }
  expect_a_ball(check_mesh(stitched(set)));
}

TEST(Stitcher, SixViewsOfABallMakeOneClosedSurface) {
  const Mesh mesh = stitched(ball());
  const MeshReport report = check_mesh(mesh);
  expect_a_ball(report);
  EXPECT_LT(report.thin_share, 0.01);
  // Outward everywhere, and nearer to the truth than a single sample.
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_GT(mesh.normals[v].dot(mesh.positions[v]), 0.0F);
  }
  EXPECT_LT(rms_off_ball(mesh), 0.01);
  EXPECT_EQ(mesh.reliability.size(), mesh.positions.size());
  EXPECT_EQ(*std::max_element(mesh.scans.begin(), mesh.scans.end()), 3);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_GE(mesh.reliability[v], 0.0F);
    ASSERT_LE(mesh.reliability[v], 1.0F);
    ASSERT_EQ(mesh.flags[v] & kVertexBoundary, 0);
  }
}

TEST(Stitcher, SameBytesForAnyNumberOfThreadsAndAnyOrder) {
  const test::ScanSet set = ball();
  Mesh one;
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    one = stitched(set);
  }
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 4);
  expect_same(one, stitched(set));
  JobContext job;
  Stitcher stitcher;
  for (const std::size_t k : {4U, 1U, 5U, 0U, 3U, 2U}) {
    ASSERT_TRUE(stitcher.add(set.placed[k], job).has_value());
  }
  expect_same(one, stitcher.mesh());
}

TEST(Stitcher, ARemovedScanLeavesNoTrace) {
  test::ScanSet set = ball();
  JobContext job;
  Stitcher stitcher;
  for (const PlacedScan& scan : set.placed) {
    ASSERT_TRUE(stitcher.add(scan, job).has_value());
  }
  EXPECT_TRUE(stitcher.remove(2));
  EXPECT_FALSE(stitcher.remove(2));
  const Mesh without = stitcher.mesh();
  set.placed.erase(set.placed.begin() + 2);
  expect_same(without, stitched(set));
}

TEST(Stitcher, MeshesInBetweenLeaveNoTrace) {
  test::ScanSet set = ball();
  JobContext job;
  Stitcher stitcher;
  for (const std::size_t k : {0U, 1U, 2U, 3U, 4U}) {
    ASSERT_TRUE(stitcher.add(set.placed[k], job).has_value());
    ASSERT_TRUE(stitcher.update(job).has_value());
  }
  const Mesh five = stitcher.mesh();
  expect_same(five, stitcher.mesh());
  ASSERT_TRUE(stitcher.add(set.placed[5], job).has_value());
  expect_same(stitcher.mesh(), stitched(set));
  EXPECT_TRUE(stitcher.remove(5));
  expect_same(stitcher.mesh(), five);
}

TEST(Stitcher, KeepsNoReferenceToAGrid) {
  const test::ScanSet set = ball();
  JobContext job;
  Stitcher stitcher;
  for (const PlacedScan& scan : set.placed) {
    const auto grid = std::make_unique<RangeGrid>(*scan.grid);
    PlacedScan passing = scan;
    passing.grid = grid.get();
    ASSERT_TRUE(stitcher.add(passing, job).has_value());
  }
  expect_same(stitcher.mesh(), stitched(set));
}

TEST(Stitcher, ADuplicatedScanChangesNoTopology) {
  test::ScanSet set = ball();
  PlacedScan again = set.placed[0];
  again.id = 6;
  set.placed.push_back(again);
  const Mesh mesh = stitched(set);
  expect_a_ball(check_mesh(mesh));
  EXPECT_LT(rms_off_ball(mesh), 0.01);
  // Nor is anything known better by it, or supported by more scans.
  expect_same(mesh, stitched(ball()));
}

TEST(Stitcher, PosesThatAreOffStillGiveOneSoundSurface) {
  test::ScanSet set = ball();
  Random random(5);
  for (PlacedScan& scan : set.placed) {
    const Eigen::Vector3d off = 0.2 * random.normal3().normalized();
    scan.model_from_scanner = RigidTransform::from_twist({0, 0, 0}, off) * scan.model_from_scanner;
  }
  const Mesh mesh = stitched(set);
  const MeshReport report = check_mesh(mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_GT(static_cast<double>(report.largest_component), 0.98 * static_cast<double>(report.faces));
  EXPECT_NEAR(report.area_mm2, 4 * kPi * kRadius * kRadius, 0.05 * 4 * kPi * kRadius * kRadius);
  EXPECT_LT(rms_off_ball(mesh), 0.15);

  JobContext job;
  Stitcher stitcher;
  double worst = 0;
  for (const PlacedScan& scan : set.placed) {
    ASSERT_TRUE(stitcher.add(scan, job).has_value());
  }
  for (const Stitcher::Overlap& overlap : stitcher.overlaps()) {
    worst = std::max(worst, overlap.step_mm);
  }
  EXPECT_GT(worst, 0.05);
}

TEST(Stitcher, ASparseSampleOnAWellSampledSheetIsNoSparseVertex) {
  // Both scans hold the same sheet, the one near enough to be primary is sparse all over its right half.
  test::ScanSet set;
  const auto flat = [](double, double) { return 0.0; };
  set.add(test::height_grid(31, 31, 0.1, flat), {});
  set.add(test::height_grid(31, 32, 0.1, flat), {Eigen::Matrix3d::Identity(), {0.03, 0.03, 0.0}});
  for (auto& flags : set.flags) {
    std::fill(flags.begin(), flags.end(), std::uint8_t{0});
  }
  for (int row = 0; row < 31; ++row) {
    for (int col = 15; col < 31; ++col) {
      set.flags[0][set.placed[0].grid->index(row, col)] = kSparse;
    }
  }
  const Mesh mesh = stitched(set);
  ASSERT_GT(mesh.positions.size(), 500U);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // At the rim one scan is alone.
    if (mesh.positions[i].cwiseAbs().maxCoeff() < 1.3F) {
      EXPECT_EQ(mesh.flags[i] & kVertexSparse, 0);
    }
  }
}

TEST(Stitcher, KnowsHowFarItsVerticesAreOff) {
  test::ScanSet set;
  for (int side = 0; side < 6; ++side) {
    set.add(ball_grid(0.1, 0.02, static_cast<std::uint64_t>(side) + 1), view_from(side));
  }
  const Mesh mesh = stitched(set);
  ASSERT_EQ(mesh.sigma_mm.size(), mesh.positions.size());
  double squares = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const double error = (mesh.positions[i].norm() - kRadius) / mesh.sigma_mm[i];
    squares += std::min(error * error, 25.0);
  }
  const double mean_square = squares / static_cast<double>(mesh.positions.size());
  // The noise is along the view and does not grow with the slope here: along the normal it is less.
  EXPECT_GT(mean_square, 0.3);
  EXPECT_LT(mean_square, 1.6);
}

TEST(Stitcher, ScansOfDifferentSpacing) {
  test::ScanSet set;
  for (int side = 0; side < 6; ++side) {
    set.add(ball_grid(side % 2 == 0 ? 0.1 : 0.25, 0.005, static_cast<std::uint64_t>(side) + 1),
            view_from(side));
  }
  const Mesh mesh = stitched(set);
  expect_a_ball(check_mesh(mesh));
  EXPECT_LT(rms_off_ball(mesh), 0.01);
}

TEST(Stitcher, NoiseAlongTheLaserFoldsNoCellOver) {
  // Three views of a plate whose noise is four fifths of the spacing.
  const auto plate = [](bool laser_known) {
    test::ScanSet set;
    for (int k = 0; k < 3; ++k) {
      Random random(static_cast<std::uint64_t>(k) + 1);
      const RigidTransform pose = RigidTransform::from_twist({0.1 * k, -0.1 * k, 0.4 * k}, {0, 0, 0});
      const Eigen::Vector3d n = pose.rotation.transpose() * Eigen::Vector3d::UnitZ();
      RangeGrid grid = test::height_grid(150, 150, 0.025, [&](double x, double y) {
        return -(n.x() * x + n.y() * y) / n.z() + 0.02 * random.normal();
      });
      if (laser_known) {
        grid.view.laser_mm = Eigen::Vector3d(0, 0, 500);
      }
      set.add(std::move(grid), pose);
    }
    return stitched(set);
  };
  const auto invented = [](const Mesh& mesh) {
    return std::ranges::count_if(mesh.flags, [](std::uint8_t f) { return (f & kVertexInterpolated) != 0; });
  };
  const Mesh along_normals = plate(false);
  const Mesh along_rays = plate(true);
  EXPECT_LT(check_mesh(along_rays).thin_share, 0.003);
  EXPECT_LT(check_mesh(along_rays).thin_share, 0.5 * check_mesh(along_normals).thin_share);
  EXPECT_LT(invented(along_rays), invented(along_normals));
}

TEST(Stitcher, OpenWhereNothingWasSeen) {
  test::ScanSet set = ball();
  set.placed.erase(set.placed.begin() + 1);  // nobody looked from below; the sides see part of it
  const MeshReport report = check_mesh(stitched(set));
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 1U);
}

/// 60 x 60 samples, those of `rows` x `cols` from (30, 30) on missing.
RangeGrid with_a_hole(int rows, int cols) {
  RangeGrid grid = test::height_grid(60, 60, 0.1, [](double x, double y) { return 0.1 * x * y; });
  for (int r = 30; r < 30 + rows; ++r) {
    for (int c = 30; c < 30 + cols; ++c) {
      grid.valid[grid.index(r, c)] = 0;
    }
  }
  return grid;
}

std::size_t interpolated_in(const Mesh& mesh) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if ((mesh.flags[v] & kVertexInterpolated) != 0) {
      ++count;
      EXPECT_EQ(mesh.scans[v], 0);
      EXPECT_EQ(mesh.reliability[v], 0.0F);
    }
  }
  return count;
}

TEST(Stitcher, SmallGapsAreFilledAndMarked) {
  test::ScanSet set;
  set.add(with_a_hole(2, 5), {});
  const Mesh mesh = stitched(set);
  EXPECT_EQ(check_mesh(mesh).boundary_loops, 1U);
  EXPECT_GT(interpolated_in(mesh), 0U);
  EXPECT_LT(interpolated_in(mesh), 40U);
  test::ScanSet four;
  four.add(with_a_hole(2, 2), {});
  EXPECT_EQ(check_mesh(stitched(four)).boundary_loops, 1U);
}

TEST(Stitcher, HolesOfTheRedMapStayOpen) {
  for (const auto& [rows, cols] : {std::pair(3, 3), {4, 4}, {5, 5}, {3, 20}}) {
    test::ScanSet set;
    set.add(with_a_hole(rows, cols), {});
    const auto sparse = std::ranges::count_if(set.flags[0], [](std::uint8_t f) { return !is_unflagged(f); });
    test::ScanSet whole;
    whole.add(with_a_hole(0, 0), {});
    const auto at_border =
        std::ranges::count_if(whole.flags[0], [](std::uint8_t f) { return !is_unflagged(f); });
    EXPECT_GT(sparse, at_border);  // the hole is red
    const Mesh mesh = stitched(set);
    EXPECT_EQ(check_mesh(mesh).boundary_loops, 2U) << rows << " x " << cols;
    EXPECT_EQ(interpolated_in(mesh), 0U) << rows << " x " << cols;
  }
}

TEST(Stitcher, OpeningsThatAnotherScanCoversAreClosedWithItsSamples) {
  // Too few samples for a patch of their own: nine at the most, half a spacing off.
  for (const int side : {2, 3}) {
    test::ScanSet set;
    set.add(with_a_hole(side, side), {});
    RigidTransform aside;
    aside.translation_mm = {0.05, 0.05, 0};
    set.add(test::height_grid(60, 60, 0.1, [](double x, double y) { return 0.1 * (x + 0.05) * (y + 0.05); }),
            aside);
    const Mesh mesh = stitched(set);
    EXPECT_EQ(check_mesh(mesh).boundary_loops, 1U) << side;
    EXPECT_EQ(interpolated_in(mesh), 0U) << side;
    const float from = 0.05F, to = 0.05F + 0.1F * static_cast<float>(side - 1);
    const auto within = std::ranges::count_if(mesh.positions, [&](const Eigen::Vector3f& p) {
      return p.x() > from - 0.08F && p.x() < to + 0.08F && p.y() > from - 0.08F && p.y() < to + 0.08F;
    });
    EXPECT_GT(within, side == 2 ? 0 : 3) << side;
    for (const Eigen::Vector3f& p : mesh.positions) {
      ASSERT_NEAR(p.z(), 0.1F * p.x() * p.y(), 1e-3F);
    }
  }
}

TEST(Stitcher, SpecksGo) {
  RangeGrid grid = test::height_grid(60, 60, 0.1, [](double x, double y) {
    const bool speck = std::hypot(x - 2.5, y - 2.5) < 0.15;
    return speck ? 5.0 : std::hypot(x, y) < 2 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  });
  test::ScanSet set;
  set.add(grid, {});
  std::fill(set.flags[0].begin(), set.flags[0].end(), std::uint8_t{0});
  const MeshReport report = check_mesh(stitched(set));
  EXPECT_EQ(report.components, 1U);
  EXPECT_LT(report.box.max().z(), 1.0F);
}

TEST(Stitcher, NothingToStitch) {
  JobContext job;
  EXPECT_TRUE(stitch({}, {}, job)->faces.empty());
  test::ScanSet set;
  set.add(RangeGrid{}, {});
  set.add(test::height_grid(1, 50, 0.1, [](double, double) { return 0.0; }), {});
  RangeGrid invalid;
  invalid.allocate(10, 10);
  set.add(invalid, {});
  set.add(ball_grid(0.3, 0, 1), {});
  std::fill(set.flags[3].begin(), set.flags[3].end(), std::uint8_t{kNotTablet});
  EXPECT_TRUE(stitched(set).faces.empty());
}

TEST(Stitcher, SparseSamplesAreKeptWhereNothingBetterIs) {
  // The right half of the first scan is sparse; the second scan sees a part of it well.
  test::ScanSet set;
  const auto flat = [](double, double) { return 0.0; };
  set.add(test::height_grid(41, 41, 0.1, flat), {});
  set.add(test::height_grid(41, 11, 0.1, flat), {Eigen::Matrix3d::Identity(), {1.0, 0.0, 0.0}});
  for (auto& flags : set.flags) {
    std::fill(flags.begin(), flags.end(), std::uint8_t{0});
  }
  for (int row = 0; row < 41; ++row) {
    for (int col = 20; col < 41; ++col) {
      set.flags[0][set.placed[0].grid->index(row, col)] = kSparse;
    }
  }
  const Mesh mesh = stitched(set);
  std::size_t sparse = 0;
  std::size_t sparse_where_seen_well = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if ((mesh.flags[i] & kVertexSparse) != 0) {
      ++sparse;
      sparse_where_seen_well += std::abs(mesh.positions[i].x() - 1.0F) < 0.35F ? 1 : 0;
    }
  }
  EXPECT_GT(sparse, 100U);
  EXPECT_EQ(sparse_where_seen_well, 0U);
}

TEST(Stitcher, RefusesWhatItCannotPlace) {
  test::ScanSet set = ball(0.4);
  JobContext job;
  Stitcher stitcher;
  ASSERT_TRUE(stitcher.add(set.placed[0], job).has_value());
  EXPECT_EQ(stitcher.add(set.placed[0], job).error().kind, ErrorKind::kUsage);
  PlacedScan bad = set.placed[1];
  bad.grid = nullptr;
  EXPECT_EQ(stitcher.add(bad, job).error().kind, ErrorKind::kBadInput);
  bad = set.placed[1];
  bad.model_from_scanner.rotation *= 2.0;
  EXPECT_EQ(stitcher.add(bad, job).error().kind, ErrorKind::kBadInput);
  bad = set.placed[1];
  bad.model_from_scanner.translation_mm.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stitcher.add(bad, job).error().kind, ErrorKind::kBadInput);
  bad = set.placed[1];
  const SampleFlags short_flags(3, 0);
  bad.flags = &short_flags;
  EXPECT_EQ(stitcher.add(bad, job).error().kind, ErrorKind::kBadInput);
  job.cancel();
  EXPECT_EQ(stitcher.add(set.placed[1], job).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(stitch(set.placed, {}, job).error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(check_mesh(stitcher.mesh()).is_manifold());
}

TEST(Stitcher, OfSeveralTheOnesBeforeABadOneAreIn) {
  test::ScanSet set = ball(0.4);
  const JobContext job;
  std::vector<PlacedScan> several = set.placed;
  several[2].model_from_scanner.rotation *= 2.0;
  Stitcher stitcher;
  EXPECT_EQ(stitcher.add(several, job).error().kind, ErrorKind::kBadInput);
  set.placed.resize(2);
  expect_same(stitcher.mesh(), stitched(set));
}

TEST(Stitcher, ACoarseScanTakesNothingFromAFineOneThatSeesAsWell) {
  // Before, scans that look equally straight stood side by side whatever their spacing: of these the coarse
  // one's rows made the mesh.
  const auto flat = [](double, double) { return 0.0; };
  test::ScanSet fine;
  fine.add(test::height_grid(61, 61, 0.1, flat), {});
  test::ScanSet both;
  both.add(test::height_grid(31, 31, 0.4, flat), {});
  both.add(test::height_grid(61, 61, 0.1, flat), {});
  const Mesh alone = stitched(fine);
  const Mesh mesh = stitched(both);
  std::size_t within = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    within += p.head<2>().cwiseAbs().maxCoeff() < 2.5F ? 1 : 0;
  }
  EXPECT_GT(alone.positions.size(), 3000U);
  EXPECT_GT(within, 2400U);  // 51 x 51; of the coarse one there are 13 x 13
}

}  // namespace
}  // namespace dubsar
