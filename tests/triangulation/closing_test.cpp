// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/closing.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/chunk_loop.h"
#include "core/random.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/mesh_check.h"
#include "triangulation/slivers.h"
#include "triangulation/tiling.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;

TEST(Tiling, APlaceLiesInTheBoxOfItsTileAndInNoOther) {
  const Eigen::AlignedBox3f box(Vector3f(-3, 2, 0), Vector3f(7, 5, 1));
  Random random(3);
  for (const float shift : {0.0F, 0.5F}) {
    const Tiling tiling(box, 1.7F, shift);
    ASSERT_GT(tiling.size(), 10U);
    for (int k = 0; k < 2000; ++k) {
      const Vector3f p =
          box.min() + Vector3f{static_cast<float>(random.uniform()), static_cast<float>(random.uniform()),
                               static_cast<float>(random.uniform())}
                          .cwiseProduct(box.sizes());
      for (std::size_t tile = 0; tile < tiling.size(); ++tile) {
        if (lies_within(tiling.box(tile), p, 1e-5F)) {
          EXPECT_EQ(tile, tiling.tile_of(p));
        }
      }
      EXPECT_TRUE(lies_within(tiling.box(tiling.tile_of(p)), p, -1e-5F));
    }
  }
}

TEST(Tiling, WithoutTilesEverythingIsOne) {
  const Tiling tiling;
  EXPECT_EQ(tiling.size(), 1U);
  EXPECT_EQ(tiling.tile_of({1e9F, -5, 0}), 0U);
  EXPECT_TRUE(lies_within(tiling.box(0), {1e9F, -5, 0}, 1e9F));
}

/// One wavy sheet cut into pieces by jagged lanes of about two samples, with small holes: as patches are
/// before their seams are closed.
Draft cut_sheet(int side, int piece) {
  constexpr double kMu = 0.1;
  Random random(11);
  RangeGrid grid = test::height_grid(side, side, kMu,
                                     [](double x, double y) { return 0.15 * std::sin(2 * x) * std::cos(y); });
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const int r = row + static_cast<int>(1.5 * std::sin(0.7 * col));
      const int c = col + static_cast<int>(1.5 * std::sin(0.9 * row));
      if (r % piece == 0 || c % piece == 0 || random.uniform() < 0.01) {
        grid.valid[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(col)] = 0;
      }
    }
  }
  Draft draft;
  draft.mesh = triangulate_grid(grid, {});
  const std::size_t count = draft.mesh.positions.size();
  draft.mesh.reliability.assign(count, 1);
  draft.mesh.sigma_mm.assign(count, 0.01F);
  draft.mesh.scans.assign(count, 1);
  draft.mesh.flags.assign(count, 0);
  draft.near_rim.assign(count, 1);
  draft.first_vertex = {0, static_cast<std::uint32_t>(count)};
  draft.first_face = {0, static_cast<std::uint32_t>(draft.mesh.faces.size())};
  draft.patch_spacing_mm = {static_cast<float>(kMu)};
  return draft;
}

MeshReport report_of(Draft draft) {
  std::erase_if(draft.mesh.faces, is_gone);
  return check_mesh(draft.mesh);
}

/// Two strips of one plane whose facing rims have each a corner that nearly lies on an edge of the other.
TEST(Closing, SliversThatAnEdgeFlipHelpsAreFlipped) {
  Draft draft;
  draft.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5F, 0.02F, 0}, {0.5F, -0.8F, 0}, {0.5F, 0.9F, 0}};
  const std::size_t count = draft.mesh.positions.size();
  draft.mesh.normals.assign(count, {0, 0, 1});
  draft.mesh.sigma_mm.assign(count, 0.01F);
  draft.mesh.flags.assign(count, 0);
  draft.near_rim.assign(count, 1);
  draft.first_vertex = {0, static_cast<std::uint32_t>(count)};
  draft.patch_spacing_mm = {1.0F};
  // The needle 0-1-2 lies between the face below and those above.
  draft.mesh.faces = {{0, 3, 1}, {0, 2, 4}, {2, 1, 4}};
  draft.first_face = {0, 3};
  draft.mesh.faces.push_back({0, 1, 2});
  EXPECT_EQ(remove_slivers(draft, 3), 1U);
  const MeshReport report = report_of(draft);
  EXPECT_EQ(report.faces, 4U);
  EXPECT_EQ(report.boundary_edges, 4U);
  EXPECT_EQ(report.thin_share, 0);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_NEAR(report.area_mm2, 0.85, 1e-6);
  // One that stands off the plane is there because its samples are.
  draft.mesh.faces = {{0, 3, 1}, {0, 2, 4}, {2, 1, 4}, {0, 1, 2}};
  draft.mesh.positions[2] = {0.5F, 0, 0.07F};
  EXPECT_EQ(remove_slivers(draft, 3), 0U);
}

Draft with_a_sliver_on_the_rim() {
  Draft draft;
  draft.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5F, 0.02F, 0}, {0.5F, 0.9F, 0}};
  draft.mesh.normals.assign(4, {0, 0, 1});
  draft.mesh.sigma_mm.assign(4, 0.01F);
  draft.near_rim.assign(4, 1);
  draft.first_vertex = {0, 4};
  draft.patch_spacing_mm = {1.0F};
  draft.mesh.faces = {{0, 2, 3}, {2, 1, 3}, {0, 1, 2}};
  draft.first_face = {0, 2};
  return draft;
}

/// Where its longest edge is open nothing stands beyond it.
TEST(Closing, ASliverOnTheRimGoes) {
  Draft draft = with_a_sliver_on_the_rim();
  EXPECT_EQ(remove_slivers(draft, 2), 1U);
  EXPECT_EQ(report_of(draft).faces, 2U);
  EXPECT_TRUE(report_of(draft).is_manifold());
}

/// Only there patches may cut themselves: who forgets it looks for no cuts.
TEST(Closing, TheRimOfAPatchStaysItsRimWhenASeamIsClosedAlongIt) {
  Draft draft = cut_sheet(60, 12);
  const std::vector<std::uint8_t> rim = rim_vertices(draft.mesh.faces, draft.mesh.positions.size());
  for (std::size_t v = 0; v < rim.size(); ++v) {
    draft.near_rim[v] = rim[v] != 0 ? Draft::kAtRim : draft.near_rim[v];
  }
  const std::size_t faces = draft.mesh.faces.size();
  close_patches(draft, {}, JobContext{});
  ASSERT_GT(draft.mesh.faces.size(), faces + 500U);
  for (std::size_t v = 0; v < rim.size(); ++v) {
    EXPECT_TRUE(rim[v] == 0 || draft.near_rim[v] == Draft::kAtRim);
  }
}

TEST(Closing, TilesLeaveNoTraceOfTheirSides) {
  const Draft cut = cut_sheet(160, 12);
  ASSERT_GT(report_of(cut).components, 100U);
  for (const double tile_spacings : {25.0, 60.0, 0.0}) {
    SCOPED_TRACE(tile_spacings);
    Draft draft = cut;
    ClosingOptions options;
    options.tile_spacings = tile_spacings;
    options.least_tiled_vertices = tile_spacings > 0 ? 0 : cut.mesh.positions.size() + 1;
    close_patches(draft, options, JobContext{});
    repair_self_intersections(draft, options, JobContext{});
    const MeshReport report = report_of(draft);
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.boundary_loops, 1U);
    EXPECT_EQ(report.non_manifold_edges + report.non_manifold_vertices, 0U);
    EXPECT_EQ(report.inconsistent_faces, 0U);
    EXPECT_EQ(report.self_intersections, 0U);
    EXPECT_LT(report.thin_share, 0.01);
  }
}

/// Whoever looks for cuts among them and is not stopped holds each against each.
Draft faces_in_one_place(std::uint32_t count) {
  Draft draft;
  draft.first_vertex = {0, 0};
  draft.first_face = {0, 0};
  draft.patch_spacing_mm = {1.0F};
  for (std::uint32_t k = 0; k < count; ++k) {
    draft.mesh.positions.insert(draft.mesh.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    draft.mesh.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  draft.near_rim.assign(draft.mesh.positions.size(), 1);
  return draft;
}

TEST(Closing, ACancelledJobHasNothingDone) {
  JobContext job;
  job.cancel();
  Draft draft = cut_sheet(60, 12);
  const std::vector<Triangle> before = draft.mesh.faces;
  close_patches(draft, {}, job);
  EXPECT_EQ(draft.mesh.faces, before);
  std::size_t comparisons = 0;
  ClosingOptions options;
  options.counted = [&](std::size_t more) { comparisons += more; };
  draft = faces_in_one_place(100);
  repair_self_intersections(draft, options, job);
  EXPECT_EQ(comparisons, 0U);
}

TEST(Closing, ASearchForCutsEndsWhenItIsStopped) {
  constexpr std::uint32_t kFaces = 4000;
  Draft draft = faces_in_one_place(kFaces);
  JobContext job;
  std::atomic<std::size_t> comparisons{0};
  ClosingOptions options;
  options.counted = [&](std::size_t more) {
    comparisons += more;
    job.cancel();
  };
  repair_self_intersections(draft, options, job);
  EXPECT_GT(comparisons, 0U);
  EXPECT_LE(comparisons, std::size_t{2} * kFaces * chunks_at_once());
}

TEST(Closing, NoSeamNorGapIsClosedNorSliverFlippedForACancelledJob) {
  JobContext job;
  job.cancel();
  Sheet sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.6F, 0.8F, 0}, {0.8F, 1.6F, 0}, {1.8F, 1.8F, 0}};
  sheet.normals.assign(6, {0, 0, 1});
  sheet.spacing_mm.assign(6, 1.0F);
  sheet.sigma_mm.assign(6, 0.01F);
  sheet.whole.assign(6, 1);
  sheet.room = {Vector3f::Constant(-100), Vector3f::Constant(100)};
  sheet.faces = {{0, 1, 2}, {3, 5, 4}};
  Sheet again = sheet;
  Front front(sheet);
  EXPECT_EQ(close_seams(front, {}, job), 0U);
  EXPECT_EQ(fill_gaps(front, {}, {}, job).faces, 0U);
  Front other(again);
  EXPECT_GT(close_seams(other, {}), 0U);

  Draft draft = with_a_sliver_on_the_rim();
  EXPECT_EQ(remove_slivers(draft, 2, job), 0U);
  EXPECT_EQ(draft.mesh.faces.size(), 3U);
}

}  // namespace
}  // namespace dubsar
