// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Loops, components and fans of meshes whose faces are not all turned the same way, or meet by the three.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "triangulation/half_edges.h"
#include "triangulation/mesh_check.h"

namespace dubsar {
namespace {

/// n by n squares of 1 mm, each of two faces.
Mesh sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t r = 0; r <= n; ++r) {
    for (std::uint32_t c = 0; c <= n; ++c) {
      mesh.positions.emplace_back(static_cast<float>(c), static_cast<float>(r), 0.0F);
    }
  }
  for (std::uint32_t r = 0; r < n; ++r) {
    for (std::uint32_t c = 0; c < n; ++c) {
      const std::uint32_t i = r * (n + 1) + c;
      mesh.faces.push_back({i, i + 1, i + n + 1});
      mesh.faces.push_back({i + 1, i + n + 2, i + n + 1});
    }
  }
  return mesh;
}

/// A third face at an edge of the sheet, with a vertex of its own.
void add_fin(Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  mesh.positions.emplace_back(0.5F * (mesh.positions[a] + mesh.positions[b]) + Eigen::Vector3f(0, 0, 1));
  mesh.faces.push_back({a, b, static_cast<std::uint32_t>(mesh.positions.size() - 1)});
}

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    mesh.faces.push_back({k, (k + 1) % 4, 4});
    mesh.faces.push_back({(k + 1) % 4, k, 5});
  }
  return mesh;
}

Mesh moebius_strip(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double turn_rad = 2 * std::numbers::pi * k / n;
    for (const double side : {-1.0, 1.0}) {
      const double radius_mm = 10 + side * std::cos(turn_rad / 2);
      mesh.positions.push_back(Eigen::Vector3d(radius_mm * std::cos(turn_rad), radius_mm * std::sin(turn_rad),
                                               side * std::sin(turn_rad / 2))
                                   .cast<float>());
    }
    const std::uint32_t a = 2 * k;
    const std::uint32_t c = k + 1 < n ? a + 2 : 1;
    const std::uint32_t d = k + 1 < n ? a + 3 : 0;
    mesh.faces.push_back({a, a + 1, c});
    mesh.faces.push_back({a + 1, d, c});
  }
  return mesh;
}

/// Each edge of the boundary is in one loop, once; what check_mesh() says of them.
MeshReport checked(const Mesh& mesh) {
  const MeshReport report = check_mesh(mesh);
  const auto length_mm = [&](std::uint32_t a, std::uint32_t b) {
    return static_cast<double>((mesh.positions[a] - mesh.positions[b]).norm());
  };
  double sum_mm = 0;
  std::size_t edges = 0;
  for (const BoundaryLoop& loop : boundary_loops(mesh.faces, HalfEdges(mesh.faces, mesh.positions.size()))) {
    const std::vector<std::uint32_t>& v = loop.vertices;
    edges += loop.closed ? v.size() : v.size() - 1;
    sum_mm += loop.closed ? length_mm(v.back(), v.front()) : 0;
    for (std::size_t k = 1; k < v.size(); ++k) {
      sum_mm += length_mm(v[k - 1], v[k]);
    }
  }
  EXPECT_EQ(edges, report.boundary_edges);
  EXPECT_NEAR(sum_mm, report.boundary_length_mm, 1e-5 * sum_mm);
  EXPECT_LE(report.longest_boundary_loop_mm, report.boundary_length_mm * (1 + 1e-12));
  return report;
}

TEST(BoundaryLoops, OfASoundSheetIsOne) {
  const MeshReport report = checked(sheet(5));
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.longest_boundary_loop_mm, 20, 1e-9);
}

TEST(BoundaryLoops, TurnedFacesOpenNothing) {
  const auto turn = [](Triangle& f) { std::swap(f[0], f[1]); };
  for (const std::size_t turned : {1, 4}) {
    Mesh mesh = octahedron();
    std::for_each_n(mesh.faces.begin(), turned, turn);
    const MeshReport report = checked(mesh);
    EXPECT_GT(report.inconsistent_edges, 0U);
    EXPECT_EQ(report.boundary_loops, 0U);
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.non_manifold_vertices, 0U);
  }
  Mesh half = sheet(8);
  std::for_each_n(half.faces.begin(), half.faces.size() / 2, turn);
  const MeshReport report = checked(half);
  EXPECT_EQ(report.inconsistent_edges, 8U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.longest_boundary_loop_mm, 32, 1e-9);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
}

TEST(BoundaryLoops, AMoebiusStripHasOne) {
  const MeshReport report = checked(moebius_strip(60));
  EXPECT_EQ(report.inconsistent_edges, 1U);
  EXPECT_EQ(report.boundary_edges, 120U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.longest_boundary_loop_mm, report.boundary_length_mm, 1e-9);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
}

TEST(BoundaryLoops, AFinIsAWalkOfItsOwn) {
  for (const bool turned : {false, true}) {
    Mesh mesh = sheet(4);
    add_fin(mesh, turned ? 13 : 12, turned ? 12 : 13);
    const MeshReport report = checked(mesh);
    EXPECT_EQ(report.non_manifold_edges, 1U);
    EXPECT_EQ(report.non_manifold_vertices, 0U);
    EXPECT_EQ(report.boundary_loops, 2U);
    EXPECT_NEAR(report.longest_boundary_loop_mm, 16, 1e-9);
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.largest_component, 33U);
  }
}

/// Where each walk went around the vertices of fins as often as there are faces, it took hours.
TEST(BoundaryLoops, OfManyFins) {
  constexpr std::uint32_t kSide = 400;
  Mesh mesh = sheet(kSide);
  std::size_t fins = 0;
  for (std::uint32_t r = 1; r < kSide; r += 3) {
    for (std::uint32_t c = 1; c + 1 < kSide; c += 3) {
      add_fin(mesh, r * (kSide + 1) + c, r * (kSide + 1) + c + 1);
      ++fins;
    }
  }
  const MeshReport report = checked(mesh);
  EXPECT_EQ(report.non_manifold_edges, fins);
  EXPECT_EQ(report.boundary_loops, fins + 1);
  EXPECT_NEAR(report.longest_boundary_loop_mm, 4 * kSide, 1e-9);
  EXPECT_EQ(report.components, 1U);
}

/// Walls across a sheet, welded to it all along: the walk around it stays whole.
TEST(BoundaryLoops, OfWalls) {
  constexpr std::uint32_t kSide = 20;
  Mesh mesh = sheet(kSide);
  for (std::uint32_t r = 5; r < kSide; r += 5) {
    const auto top = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t c = 0; c <= kSide; ++c) {
      mesh.positions.emplace_back(static_cast<float>(c), static_cast<float>(r), 1.0F);
    }
    for (std::uint32_t c = 0; c < kSide; ++c) {
      const std::uint32_t below = r * (kSide + 1) + c;
      mesh.faces.push_back({below, below + 1, top + c + 1});
      mesh.faces.push_back({below, top + c + 1, top + c});
    }
  }
  const MeshReport report = checked(mesh);
  EXPECT_EQ(report.non_manifold_edges, 3U * kSide);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
  EXPECT_EQ(report.boundary_loops, 4U);
  EXPECT_NEAR(report.longest_boundary_loop_mm, 4 * kSide, 1e-9);
  EXPECT_EQ(report.components, 1U);
}

TEST(BoundaryLoops, ManyFacesAtAnEdgeAndItsCopies) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  constexpr std::uint32_t kPages = 101;
  for (std::uint32_t k = 0; k < kPages; ++k) {
    const double turn_rad = 2 * std::numbers::pi * k / kPages;
    mesh.positions.emplace_back(0.5F, static_cast<float>(std::cos(turn_rad)),
                                static_cast<float>(std::sin(turn_rad)));
    mesh.faces.push_back(k % 2 == 0 ? Triangle{0, 1, 2 + k} : Triangle{1, 0, 2 + k});
  }
  const MeshReport report = checked(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 51U);  // pages of either sense by two, one alone
  EXPECT_EQ(report.non_manifold_vertices, 0U);
}

TEST(BoundaryLoops, ACancelledJobLooksForNone) {
  const Mesh mesh = sheet(5);
  JobContext job;
  job.cancel();
  EXPECT_TRUE(boundary_loops(mesh.faces, HalfEdges(mesh.faces, mesh.positions.size()), job).empty());
}

}  // namespace
}  // namespace dubsar
