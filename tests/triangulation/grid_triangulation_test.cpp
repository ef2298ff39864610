// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/grid_triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/grid_geometry.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/mesh_check.h"

namespace dubsar {
namespace {

double flat(double, double) {
  return 0.0;
}

double least_normal_z(const Mesh& mesh) {
  double least = 1;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f n = (mesh.positions[f[1]] - mesh.positions[f[0]])
                                  .cross(mesh.positions[f[2]] - mesh.positions[f[0]])
                                  .normalized();
    least = std::min(least, static_cast<double>(n.z()));
  }
  return least;
}

bool has_edge(const Mesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.positions[f[k]];
      const Eigen::Vector3f& q = mesh.positions[f[(k + 1) % 3]];
      if (((p - a).norm() < 1e-4F && (q - b).norm() < 1e-4F) ||
          ((p - b).norm() < 1e-4F && (q - a).norm() < 1e-4F)) {
        return true;
      }
    }
  }
  return false;
}

TEST(GridTriangulation, JoinsEveryCellOfAFullGrid) {
  const Mesh mesh = triangulate_grid(test::height_grid(30, 40, 0.1, flat), {});
  const MeshReport report = check_mesh(mesh);
  EXPECT_EQ(report.vertices, 30U * 40U);
  EXPECT_EQ(report.faces, 2U * 29U * 39U);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.area_mm2, 2.9 * 3.9, 1e-3);
}

TEST(GridTriangulation, FacesTheScannerWhicheverWayTheGridRuns) {
  const auto bumpy = [](double x, double y) { return 0.3 * std::sin(2 * x) * std::cos(3 * y); };
  for (const bool mirrored : {false, true}) {
    RangeGrid grid = test::height_grid(40, 40, 0.1, bumpy, mirrored);
    EXPECT_GT(least_normal_z(triangulate_grid(grid, {})), 0.0);
    grid.view.direction = {0, 0, 1};  // the same samples seen from below
    const Mesh from_below = triangulate_grid(grid, {});
    EXPECT_GT(from_below.faces.size(), 0U);
    EXPECT_LT(least_normal_z(from_below), 0.0);
    EXPECT_TRUE(check_mesh(from_below).is_manifold());
  }
}

TEST(GridTriangulation, FacesAKnownCamera) {
  RangeGrid grid = test::height_grid(20, 20, 0.1, flat, true);
  grid.view.camera_mm = Eigen::Vector3d(0, 80, 200);
  grid.view.motion_per_row_mm = {0, 0.1, 0};
  const Mesh mesh = triangulate_grid(grid, {});
  EXPECT_EQ(mesh.faces.size(), 2U * 19U * 19U);
  EXPECT_GT(least_normal_z(mesh), 0.99);
}

TEST(GridTriangulation, DiagonalFollowsTheRidge) {
  // Ridges along x = y and x = -y: no cell may cut across either.
  const auto main_ridge = [](double x, double y) { return -0.8 * std::abs(x - y); };
  const auto anti_ridge = [](double x, double y) { return -0.8 * std::abs(x + y); };
  for (const bool anti : {false, true}) {
    const RangeGrid grid = test::height_grid(21, 21, 0.1,
                                             anti ? std::function<double(double, double)>(anti_ridge)
                                                  : std::function<double(double, double)>(main_ridge));
    const Mesh mesh = triangulate_grid(grid, {});
    for (int k = 1; k + 2 < 21; ++k) {
      const std::size_t a = grid.index(k, anti ? 20 - k : k);
      const std::size_t b = grid.index(k + 1, anti ? 19 - k : k + 1);
      EXPECT_TRUE(has_edge(mesh, grid.point(a), grid.point(b))) << "anti " << anti << " at " << k;
    }
  }
}

TEST(GridTriangulation, ThreeCornersGiveOneTriangle) {
  for (std::size_t missing = 0; missing < 4; ++missing) {
    RangeGrid grid = test::height_grid(2, 2, 0.1, flat);
    grid.valid[missing] = 0;
    const Mesh mesh = triangulate_grid(grid, {});
    EXPECT_EQ(mesh.faces.size(), 1U);
    EXPECT_EQ(mesh.positions.size(), 3U);
    EXPECT_GT(least_normal_z(mesh), 0.99);
  }
}

TEST(GridTriangulation, LeavesOutDepthStepsAndSparseSamples) {
  const auto step = [](double x, double) { return x < 0 ? 0.0 : 1.0; };
  const Mesh cut = triangulate_grid(test::height_grid(10, 20, 0.1, step), {});
  EXPECT_EQ(check_mesh(cut).components, 2U);
  EXPECT_EQ(cut.faces.size(), 2U * 9U * 18U);

  const RangeGrid grid = test::height_grid(10, 10, 0.1, flat);
  SampleFlags flags(grid.size(), 0);
  flags[grid.index(5, 5)] = kSparse;
  flags[grid.index(2, 2)] = kPotentiallySparse;  // alone it is no reason
  const Mesh mesh = triangulate_grid(grid, flags);
  EXPECT_EQ(mesh.positions.size(), 99U);
  EXPECT_EQ(check_mesh(mesh).boundary_loops, 2U);
}

TEST(GridTriangulation, SurvivesEmptyGridsAndBadNumbers) {
  EXPECT_TRUE(triangulate_grid(RangeGrid{}, {}).faces.empty());
  EXPECT_TRUE(triangulate_grid(test::height_grid(1, 100, 0.1, flat), {}).faces.empty());
  EXPECT_TRUE(triangulate_grid(test::height_grid(100, 1, 0.1, flat), {}).faces.empty());
  RangeGrid no_spacing = test::height_grid(5, 5, 0.1, flat);
  no_spacing.spacing_mm = 0;
  EXPECT_TRUE(triangulate_grid(no_spacing, {}).faces.empty());
  RangeGrid bad = test::height_grid(5, 5, 0.1, flat);
  bad.z[12] = std::numeric_limits<float>::quiet_NaN();
  bad.x[3] = std::numeric_limits<float>::infinity();
  const MeshReport report = check_mesh(triangulate_grid(bad, {}));
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.vertices, 23U);
}

TEST(GridTriangulation, CellsAreTheSameInEveryPartOfTheGrid) {
  const RangeGrid grid = test::height_grid(12, 200, 0.1, [](double x, double y) {
    return 0.15 * std::sin(9 * x + 4 * y) + 0.1 * std::cos(31 * x * y);
  });
  const GridGeometry geometry = grid_geometry(grid);
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint8_t> keep;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    points.push_back(grid.point(i));
    keep.push_back(i % 7 != 3 && i % 13 != 5 ? 1 : 0);
  }
  const GridSurface whole{grid.rows, grid.cols, grid.spacing_mm, points, geometry.normals, grid.view};
  const bool mirrored = is_mirrored(whole, keep);
  const std::vector<std::uint8_t> cells = triangulate_cells(whole, keep, mirrored, {});
  EXPECT_GT(std::set(cells.begin(), cells.end()).size(), 6U) << "all kinds of cells";
  // Row by row and from every column on: what is worked on at a time begins elsewhere.
  for (const int from : {1, 2, 3, 37, 63, 64, 65, 129, 190}) {
    const int cols = grid.cols - from;
    std::vector<Eigen::Vector3f> p, n;
    std::vector<std::uint8_t> k;
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = from; col < grid.cols; ++col) {
        p.push_back(points[grid.index(row, col)]);
        n.push_back(geometry.normals[grid.index(row, col)]);
        k.push_back(keep[grid.index(row, col)]);
      }
    }
    const GridSurface part{grid.rows, cols, grid.spacing_mm, p, n, grid.view};
    const std::vector<std::uint8_t> there = triangulate_cells(part, k, mirrored, {});
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = 0; col < cols; ++col) {
        ASSERT_EQ(there[part.index(row, col)], cells[grid.index(row, from + col)]) << from << ": " << col;
      }
    }
  }
  // Some cells again, into wrong ones: those alone are mended.
  std::vector<std::uint8_t> again(cells.size(), 9);
  std::vector<std::uint8_t> only(cells.size(), 0);
  for (std::size_t i = 0; i < only.size(); i += 5) {
    only[i] = 1;
  }
  triangulate_cells_anew(whole, keep, mirrored, {}, only, again);
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int col = 0; col + 1 < grid.cols; ++col) {
      const std::size_t i = grid.index(row, col);
      ASSERT_EQ(again[i], only[i] != 0 ? cells[i] : 9) << i;
    }
  }
}

}  // namespace
}  // namespace dubsar
