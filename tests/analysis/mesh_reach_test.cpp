// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/mesh_reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analysis/support/pits.h"

namespace dubsar {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

/// From the vertex at (-0.5, -0.5).
bool reaches(const Mesh& mesh, const Eigen::Vector3d& at) {
  const auto first = std::ranges::min_element(mesh.positions, {}, [](const Eigen::Vector3f& p) {
    return (p - Eigen::Vector3f(-0.5F, -0.5F, 0)).norm();
  });
  const std::uint32_t from[] = {static_cast<std::uint32_t>(first - mesh.positions.begin())};
  return mesh_reaches(mesh, make_vertex_graph(mesh), from, at, kUp, 0.02);
}

TEST(MeshReach, EndsWhereTheMeshDoes) {
  const Mesh mesh = pits::sheet(2, 0.1, [](double, double) { return 0.0; });
  EXPECT_TRUE(reaches(mesh, {0.43, 0.57, 0.3})) << "within a face, far from its corners";
  EXPECT_TRUE(reaches(mesh, {1.01, 0.5, 0}));
  EXPECT_FALSE(reaches(mesh, {1.1, 0.5, 0}));
  EXPECT_FALSE(mesh_reaches(mesh, make_vertex_graph(mesh), {}, {0, 0, 0}, kUp, 0.02));
}

TEST(MeshReach, GoesRoundAHoleAndNotIntoIt) {
  Mesh mesh = pits::sheet(2, 0.1, [](double, double) { return 0.0; });
  std::erase_if(mesh.faces, [&](const auto& face) { return mesh.positions[face[0]].norm() < 0.35F; });
  EXPECT_TRUE(reaches(mesh, {0.5, 0.5, 0}));
  EXPECT_FALSE(reaches(mesh, {0.03, 0.02, 0}));
}

}  // namespace
}  // namespace dubsar
