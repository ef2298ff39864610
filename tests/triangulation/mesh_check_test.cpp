// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/mesh_check.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/chunk_loop.h"

namespace dubsar {
namespace {

Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

TEST(MeshCheck, ACancelledJobLooksForNoMore) {
  JobContext job;
  job.cancel();
  const MeshReport report = check_mesh(tetrahedron(), job);
  EXPECT_EQ(report.faces, 4U);
  EXPECT_EQ(report.components, 0U);
}

/// Ends a check as soon as it looks for cuts. Of faces all of which are held against each other it must not
/// go on: each thread ends with one of them.
void expect_stopped(const Mesh& mesh) {
  JobContext job;
  std::atomic<std::size_t> comparisons{0};
  const MeshReport report = check_mesh(mesh, job, [&](std::size_t more) {
    comparisons += more;
    job.cancel();
  });
  EXPECT_EQ(report.faces, mesh.faces.size());
  EXPECT_GT(comparisons, 0U);
  EXPECT_LE(comparisons, 3 * mesh.faces.size() * chunks_at_once());
}

TEST(MeshCheck, OfFacesInOnePlaceIsStopped) {
  constexpr std::uint32_t kFaces = 4000;
  Mesh mesh;
  for (std::uint32_t k = 0; k < kFaces; ++k) {
    mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    mesh.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  expect_stopped(mesh);
}

TEST(MeshCheck, OfFacesAcrossEachOtherAtAVertexIsStopped) {
  constexpr std::uint32_t kFaces = 4000;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  for (std::uint32_t k = 0; k < kFaces; ++k) {
    const double turn_rad = 1e-5 * k;
    const auto x = static_cast<float>(std::cos(turn_rad));
    const auto y = static_cast<float>(std::sin(turn_rad));
    mesh.positions.insert(mesh.positions.end(), {{x, y, 1}, {y, x, -1}});
    mesh.faces.push_back({0, 2 * k + 1, 2 * k + 2});
  }
  expect_stopped(mesh);
}

TEST(MeshCheck, ClosedMesh) {
  const MeshReport report = check_mesh(tetrahedron());
  EXPECT_TRUE(report.is_closed());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 0U);
  EXPECT_NEAR(report.area_mm2, 1.5 + 0.5 * std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(report.box.max().x(), 1.0, 1e-6);
}

TEST(MeshCheck, OpenMeshHasALoopOfKnownLength) {
  Mesh mesh = tetrahedron();
  mesh.faces.pop_back();
  const MeshReport report = check_mesh(mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_FALSE(report.is_closed());
  EXPECT_EQ(report.boundary_edges, 3U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.boundary_length_mm, 2.0 + std::sqrt(2.0), 1e-6);
}

TEST(MeshCheck, TurnedFaceIsInconsistent) {
  Mesh mesh = tetrahedron();
  std::swap(mesh.faces[3][0], mesh.faces[3][1]);
  const MeshReport report = check_mesh(mesh);
  EXPECT_FALSE(report.is_manifold());
  EXPECT_EQ(report.inconsistent_edges, 3U);
  EXPECT_EQ(report.inconsistent_faces, 4U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_loops, 0U);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
  EXPECT_EQ(report.non_manifold_edges, 0U);
}

TEST(MeshCheck, ThirdFaceAtAnEdge) {
  Mesh mesh = tetrahedron();
  mesh.positions.push_back({1, -1, 0});
  mesh.faces.push_back({0, 1, 4});
  const MeshReport report = check_mesh(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1U);
  EXPECT_EQ(report.non_manifold_vertices, 0U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.boundary_edges, 2U);
  EXPECT_EQ(report.boundary_loops, 1U);
  EXPECT_NEAR(report.longest_boundary_loop_mm, report.boundary_length_mm, 1e-12);
  EXPECT_FALSE(report.is_manifold());
}

TEST(MeshCheck, TwoFansAtAVertex) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 3, 4}};
  const MeshReport report = check_mesh(mesh);
  EXPECT_EQ(report.non_manifold_vertices, 1U);
  EXPECT_EQ(report.components, 2U);
  EXPECT_EQ(report.boundary_loops, 2U);
  EXPECT_FALSE(report.is_manifold());
}

TEST(MeshCheck, DegenerateDuplicateAndForeignIndices) {
  Mesh mesh = tetrahedron();
  mesh.positions.push_back({2, 0, 0});  // no face uses it
  mesh.faces.push_back({1, 1, 2});
  mesh.faces.push_back({0, 1, 99});
  EXPECT_EQ(check_mesh(mesh).degenerate_faces, 2U);
  EXPECT_EQ(check_mesh(mesh).unreferenced_vertices, 1U);
  EXPECT_FALSE(check_mesh(mesh).is_manifold());

  Mesh line;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.faces = {{0, 1, 2}};
  EXPECT_EQ(check_mesh(line).degenerate_faces, 1U);
  EXPECT_EQ(check_mesh(line).thin_share, 1.0);

  Mesh twice = tetrahedron();
  twice.faces.push_back({2, 1, 0});
  EXPECT_EQ(check_mesh(twice).duplicate_faces, 1U);
}

TEST(MeshCheck, FacesThatRepeatOthersByPlaceAreCounted) {
  Mesh shells = tetrahedron();
  shells.positions.insert(shells.positions.end(), {{-0.0F, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_EQ(check_mesh(shells).repeated_faces, 0U) << "vertices alone repeat no face";
  for (const auto& f : tetrahedron().faces) {
    shells.faces.push_back({f[1] + 4, f[2] + 4, f[0] + 4});
  }
  const MeshReport report = check_mesh(shells);
  EXPECT_EQ(report.repeated_faces, 4U);
  EXPECT_EQ(report.duplicate_faces, 0U);
  EXPECT_EQ(report.components, 2U);
  EXPECT_FALSE(report.is_manifold());
  shells.positions[4].x() = 1e-6F;
  EXPECT_EQ(check_mesh(shells).repeated_faces, 1U) << "that of the other three corners";

  Mesh twice = tetrahedron();
  twice.faces.push_back({2, 1, 0});
  EXPECT_EQ(check_mesh(twice).repeated_faces, 0U) << "it is a duplicate, and counted as that";
  Mesh thrice = twice;
  thrice.positions.emplace_back(0, 0, 0);
  thrice.faces.push_back({4, 2, 1});  // a face that shares two vertices with the two of its place
  thrice.faces.push_back({4, 0, 1});  // has no area
  EXPECT_EQ(check_mesh(thrice).repeated_faces, 1U);
}

TEST(MeshCheck, OfDuplicatesOneCutsOthers) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}};
  mesh.faces.assign(20000, {0, 1, 2});
  mesh.faces.push_back({3, 4, 5});
  const MeshReport report = check_mesh(mesh);
  EXPECT_EQ(report.duplicate_faces, 19999U);
  EXPECT_EQ(report.self_intersections, 1U);
}

TEST(MeshCheck, LengthsBeyondThoseOfFloats) {
  Mesh mesh;
  mesh.positions = {{-3e38F, 0, 0}, {3e38F, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  const MeshReport report = check_mesh(mesh);
  EXPECT_NEAR(report.boundary_length_mm, 12e38, 1e33);
  EXPECT_NEAR(report.longest_boundary_loop_mm, 12e38, 1e33);
}

TEST(MeshCheck, SmallestAngleAndTheShareOfThinFaces) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -0.1F, 0}};  // 45 degrees, and 5.71
  mesh.faces = {{0, 1, 2}, {0, 3, 1}};
  const MeshReport report = check_mesh(mesh);
  EXPECT_NEAR(report.min_angle_rad, std::atan(0.1), 1e-6);
  EXPECT_EQ(report.thin_share, 0.5);
  EXPECT_NEAR(check_mesh(tetrahedron()).min_angle_rad, 0.25 * std::acos(-1.0), 1e-6);
}

TEST(MeshCheck, ManifoldAloneIsJudgedTheSame) {
  Mesh mesh = tetrahedron();
  EXPECT_TRUE(check_manifold(mesh).is_closed());
  std::swap(mesh.faces[3][0], mesh.faces[3][1]);
  EXPECT_EQ(check_manifold(mesh).inconsistent_edges, 3U);
  mesh = tetrahedron();
  mesh.faces.push_back(mesh.faces.front());
  EXPECT_EQ(check_manifold(mesh).duplicate_faces, 1U);
  EXPECT_FALSE(check_manifold(mesh).is_manifold());
}

TEST(MeshCheck, EmptyMesh) {
  const MeshReport report = check_mesh(Mesh{});
  EXPECT_TRUE(report.is_manifold());
  EXPECT_FALSE(report.is_closed());
  EXPECT_TRUE(report.box.isEmpty());
}

}  // namespace
}  // namespace dubsar
