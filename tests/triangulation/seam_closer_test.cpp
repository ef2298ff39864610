// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/seam_closer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/random.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/gap_fill.h"
#include "triangulation/grid_triangulation.h"
#include "triangulation/mesh_check.h"

namespace dubsar {
namespace {

constexpr float kSigmaMm = 0.002F;

void append(Sheet& sheet, const Mesh& mesh, float spacing_mm) {
  const auto base = static_cast<std::uint32_t>(sheet.positions.size());
  sheet.positions.insert(sheet.positions.end(), mesh.positions.begin(), mesh.positions.end());
  sheet.normals.insert(sheet.normals.end(), mesh.normals.begin(), mesh.normals.end());
  sheet.spacing_mm.resize(sheet.positions.size(), spacing_mm);
  sheet.sigma_mm.resize(sheet.positions.size(), kSigmaMm);
  for (const Triangle& f : mesh.faces) {
    sheet.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  }
}

MeshReport report_of(const Sheet& sheet) {
  Mesh mesh;
  mesh.positions = sheet.positions;
  mesh.faces = sheet.faces;
  return check_mesh(mesh);
}

TEST(SeamCloser, JoinsTwoPatchesWithoutACrack) {
  // Two grids side by side, turned and shifted against each other, with jagged facing sides about 1.2 µ
  // apart.
  constexpr double kMu = 0.1;
  const auto curve = [](double x, double y) { return 0.1 * std::sin(3 * x + y); };
  Random random(4);
  RangeGrid left = test::height_grid(40, 40, kMu, curve);
  RangeGrid right = test::height_grid(40, 40, kMu, curve);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double border = 0.15 * std::sin(7 * left.y[i]);
    left.valid[i] = left.x[i] < border - 0.06 ? 1 : 0;
  }
  for (std::size_t i = 0; i < right.size(); ++i) {
    const double x = right.x[i] * std::cos(0.4) - right.y[i] * std::sin(0.4);
    const double y = right.x[i] * std::sin(0.4) + right.y[i] * std::cos(0.4);
    right.x[i] = static_cast<float>(x);
    right.y[i] = static_cast<float>(y);
    right.z[i] = static_cast<float>(curve(x, y));
    right.valid[i] = x > 0.15 * std::sin(7 * y) + 0.06 && std::abs(y) < 1.6 ? 1 : 0;
  }
  Sheet sheet;
  append(sheet, triangulate_grid(left, {}), kMu);
  append(sheet, triangulate_grid(right, {}), kMu);
  ASSERT_EQ(report_of(sheet).components, 2U);
  Front front(sheet);
  EXPECT_GT(close_seams(front, {}), 30U);
  fill_gaps(front, {}, {});
  const MeshReport report = report_of(sheet);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_EQ(report.non_manifold_edges, 0U);
  EXPECT_EQ(report.inconsistent_faces, 0U);
  EXPECT_LT(report.thin_share, 0.01);
}

TEST(SeamCloser, DoesNotBridgeADepthStep) {
  Sheet sheet;
  append(sheet,
         triangulate_grid(test::height_grid(20, 20, 0.1, [](double x, double) { return x < 0 ? 0.0 : 0.6; }),
                          {}),
         0.1F);
  Front front(sheet);
  close_seams(front, {});
  EXPECT_EQ(report_of(sheet).components, 2U);
}

/// The patches to both sides of a right angle, each of which ends a little before it; `out`: they face away
/// from each other, around an edge, rather than into a corner.
Sheet right_angle(bool out) {
  constexpr double kMu = 0.2;
  const auto plane = [](double, double) { return 0.0; };
  RangeGrid top = test::height_grid(30, 30, kMu, plane);
  for (std::size_t i = 0; i < top.size(); ++i) {
    top.valid[i] = top.x[i] < -0.12F ? 1 : 0;
  }
  Sheet sheet;
  Mesh mesh = triangulate_grid(top, {});
  append(sheet, mesh, kMu);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {  // about the edge, x to z or to -z
    const float depth = mesh.positions[v].x();
    mesh.positions[v] = {0, mesh.positions[v].y(), out ? depth : -depth};
    mesh.normals[v] = {out ? 1.0F : -1.0F, 0, 0};
  }
  for (Triangle& f : mesh.faces) {  // the grid's other side is outside
    std::swap(f[1], f[2]);
  }
  append(sheet, mesh, kMu);
  return sheet;
}

TEST(SeamCloser, JoinsWhatLiesAroundAnEdgeAndNotIntoACorner) {
  SeamOptions over_creases;
  over_creases.min_crease_cos = -0.2;
  for (const bool out : {true, false}) {
    Sheet sheet = right_angle(out);
    ASSERT_EQ(report_of(sheet).components, 2U);
    Front front(sheet);
    EXPECT_EQ(close_seams(front, {}), 0U);
    close_seams(front, over_creases);
    const MeshReport report = report_of(sheet);
    EXPECT_EQ(report.components, out ? 1U : 2U);
    EXPECT_EQ(report.inconsistent_faces, 0U);
    EXPECT_EQ(report.self_intersections, 0U);
    if (out) {
      EXPECT_EQ(report.boundary_loops, 1U);
    }
  }
}

TEST(GapFill, FillsAFewSamplesAndLeavesWideHoles) {
  RangeGrid grid = test::height_grid(80, 80, 0.1, [](double x, double y) { return 0.05 * (x * x + y * y); });
  const auto dig = [&](int row, int col, int radius) {
    for (int r = row - radius; r <= row + radius; ++r) {
      for (int c = col - radius; c <= col + radius; ++c) {
        grid.valid[grid.index(r, c)] = 0;
      }
    }
  };
  dig(15, 15, 0);
  dig(15, 40, 1);
  dig(40, 15, 2);
  dig(55, 55, 8);
  Sheet sheet;
  append(sheet, triangulate_grid(grid, {}), 0.1F);
  const std::size_t measured = sheet.positions.size();
  ASSERT_EQ(report_of(sheet).boundary_loops, 5U);
  Front front(sheet);
  close_seams(front, {});
  const GapFillResult filled = fill_gaps(front, {}, {});
  EXPECT_EQ(filled.first_interpolated, measured);
  const MeshReport report = report_of(sheet);
  EXPECT_EQ(report.boundary_loops, 2U);
  EXPECT_TRUE(report.is_manifold());
  ASSERT_GT(sheet.positions.size(), measured);
  EXPECT_LT(sheet.positions.size(), measured + 40U);
  for (std::size_t v = measured; v < sheet.positions.size(); ++v) {
    const Eigen::Vector3f& p = sheet.positions[v];
    EXPECT_NEAR(p.z(), 0.05F * (p.x() * p.x() + p.y() * p.y()), 0.01F);
  }
}

TEST(GapFill, WhatIsSparseAroundAHoleLeavesItOpen) {
  RangeGrid grid = test::height_grid(40, 40, 0.1, [](double, double) { return 0.0; });
  for (const auto& [row, col, side] : {std::array{10, 10, 3}, {10, 25, 2}, {25, 10, 1}, {25, 25, 4}}) {
    for (int r = row; r < row + side; ++r) {
      for (int c = col; c < col + side; ++c) {
        grid.valid[grid.index(r, c)] = 0;
      }
    }
  }
  Sheet sheet;
  append(sheet, triangulate_grid(grid, {}), 0.1F);
  sheet.marks.assign(sheet.positions.size(), kSparseMark);
  ASSERT_EQ(report_of(sheet).boundary_loops, 5U);
  Front front(sheet);
  close_seams(front, {});
  fill_gaps(front, {}, {});
  EXPECT_EQ(report_of(sheet).boundary_loops, 3U);
}

TEST(Front, RefusesAHalfEdgeTwice) {
  Sheet sheet;
  append(sheet, triangulate_grid(test::height_grid(2, 2, 0.1, [](double, double) { return 0.0; }), {}), 0.1F);
  Front front(sheet);
  for (const Triangle& f : std::vector<Triangle>(sheet.faces)) {
    EXPECT_FALSE(front.accepts(f));
  }
  EXPECT_EQ(front.open_edges().size(), 4U);
  ASSERT_EQ(front.openings().size(), 1U);
  EXPECT_EQ(front.openings()[0].size(), 4U);
}

TEST(SeamCloser, RimsThatLieFarDenserThanTheySayAreLeftOpenInNoTime) {
  // Each triangle of a grid whose columns were mixed up stands by itself, and its spacing is taken for 5 mm:
  // all rims lie within reach of each. Looking at all of them for each would take longer than a test may.
  Random random(9);
  Sheet sheet;
  Mesh crumbs;
  for (std::uint32_t k = 0; k < 40000; ++k) {
    const auto x = static_cast<float>(random.uniform());
    const auto y = static_cast<float>(random.uniform());
    for (const auto& [dx, dy] : {std::pair(0.0F, 0.0F), std::pair(0.001F, 0.0F), std::pair(0.0F, 0.001F)}) {
      crumbs.positions.emplace_back(x + dx, y + dy, 0.0F);
      crumbs.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
    crumbs.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  append(sheet, crumbs, 5.0F);
  Front front(sheet);
  std::vector<const Front::Links*> near;
  EXPECT_FALSE(front.near({0.5F, 0.5F, 0.0F}, 3.0F, near));
  EXPECT_EQ(close_seams(front, {}), 0U);
}

}  // namespace
}  // namespace dubsar
