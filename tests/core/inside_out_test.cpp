// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/inside_out.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

/// An octahedron about a place far from the origin, less its first `missing` faces.
Mesh octahedron(std::size_t missing = 0) {
  Mesh mesh;
  for (int k = 0; k < 3; ++k) {
    for (const float side : {1.0F, -1.0F}) {
      mesh.positions.push_back(Eigen::Vector3f(900, 0, 0) + side * Eigen::Vector3f::Unit(k));
    }
  }
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  mesh.faces.erase(mesh.faces.begin(), mesh.faces.begin() + static_cast<std::ptrdiff_t>(missing));
  return mesh;
}

TEST(InsideOut, FacesThatLookInwardsAreTold) {
  Mesh mesh = octahedron();
  EXPECT_NEAR(signed_volume_mm3(mesh), 4.0 / 3, 1e-4);
  EXPECT_FALSE(is_inside_out(mesh));
  mesh.normals = vertex_normals(mesh);
  turn_over(&mesh);
  EXPECT_NEAR(signed_volume_mm3(mesh), -4.0 / 3, 1e-4);
  EXPECT_TRUE(is_inside_out(mesh));
  EXPECT_EQ(mesh.normals[0], vertex_normals(mesh)[0]);
  mesh.faces.push_back({0, 1, 99});
  EXPECT_TRUE(is_inside_out(mesh)) << "a broken face counts for nothing";
}

TEST(InsideOut, AnOpenMeshIsDoubtedOnlyWhereItClearlyBulges) {
  EXPECT_FALSE(is_inside_out(Mesh{}));
  Mesh half = octahedron(4);
  EXPECT_FALSE(is_inside_out(half));
  turn_over(&half);
  EXPECT_TRUE(is_inside_out(half));
  for (Eigen::Vector3f& p : half.positions) {
    p.z() *= 0.2F;
  }
  EXPECT_FALSE(is_inside_out(half)) << "it may be a bowl";
}

}  // namespace
}  // namespace dubsar
