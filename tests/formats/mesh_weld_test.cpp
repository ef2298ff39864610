// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"

namespace dubsar {
namespace {

/// A square of two faces, one with two corners in one place, and one that is a point.
TEST(MeshWeld, FacetsWithTwoCornersInOnePlaceStay) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.faces = {{0, 1, 2}, {1, 3, 2}, {0, 0, 3}, {2, 2, 2}};
  const Result<Mesh> read = read_mesh_bytes(encode_mesh_stl(mesh), "a.stl");
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->positions.size(), 4U);
  ASSERT_EQ(read->faces.size(), 4U);
  for (std::size_t f = 0; f < 4; ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(read->positions[read->faces[f][k]], mesh.positions[mesh.faces[f][k]]);
    }
  }
}

}  // namespace
}  // namespace dubsar
