// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/mesh_reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analysis/support/pits.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

/// From the vertex at (-0.5, -0.5), of the upper side.
bool reaches(const Mesh& mesh, const Eigen::Vector3d& at) {
  const auto first = std::ranges::min_element(mesh.positions, {}, [](const Eigen::Vector3f& p) {
    return (p - Eigen::Vector3f(-0.5F, -0.5F, 0.5F)).norm();
  });
  const std::uint32_t from[] = {static_cast<std::uint32_t>(first - mesh.positions.begin())};
  return mesh_reaches(mesh, make_vertex_graph(mesh), mesh.normals, from, at, kUp, 0.02);
}

Mesh with_normals(Mesh mesh) {
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

TEST(MeshReach, EndsWhereTheMeshDoes) {
  const Mesh mesh = pits::sheet(2, 0.1, [](double, double) { return 0.0; });
  EXPECT_TRUE(reaches(mesh, {0.43, 0.57, 0.3})) << "within a face, far from its corners";
  EXPECT_TRUE(reaches(mesh, {1.01, 0.5, 0}));
  EXPECT_FALSE(reaches(mesh, {1.1, 0.5, 0}));
  EXPECT_FALSE(mesh_reaches(mesh, make_vertex_graph(mesh), mesh.normals, {}, {0, 0, 0}, kUp, 0.02));
}

TEST(MeshReach, GoesRoundAHoleAndNotIntoIt) {
  Mesh mesh = pits::sheet(2, 0.1, [](double, double) { return 0.0; });
  std::erase_if(mesh.faces, [&](const auto& face) { return mesh.positions[face[0]].norm() < 0.35F; });
  EXPECT_TRUE(reaches(mesh, {0.5, 0.5, 0}));
  EXPECT_FALSE(reaches(mesh, {0.03, 0.02, 0}));
}

TEST(MeshReach, TheOtherSideOfASherdIsNotTheClayOfAHole) {
  Mesh sherd = shapes::box({1, 1, 0.25F}, 20);
  EXPECT_TRUE(reaches(with_normals(sherd), {0.03, 0.02, 0.25}));
  std::erase_if(sherd.faces, [&](const auto& face) {
    const Eigen::Vector3f& p = sherd.positions[face[0]];
    return p.z() > 0.24F && p.head<2>().norm() < 0.35F;
  });
  EXPECT_FALSE(reaches(with_normals(sherd), {0.03, 0.02, 0.25})) << "round the rim is no way";
  EXPECT_TRUE(reaches(with_normals(sherd), {0.95, 0.95, 0.25}));
}

}  // namespace
}  // namespace dubsar
