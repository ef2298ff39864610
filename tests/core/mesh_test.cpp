// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(VertexNormals, ATriangleThatNamesAVertexThatIsNotThereCountsForNothing) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 1, 7}, {1'000'000, 2, 1}};
  const std::vector<Eigen::Vector3f> normals = vertex_normals(mesh);
  ASSERT_EQ(normals.size(), 3U);
  for (const Eigen::Vector3f& normal : normals) {
    EXPECT_EQ(normal, Eigen::Vector3f::UnitZ());
  }
}

}  // namespace
}  // namespace dubsar
