// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Meshes so far from the origin that float would destroy them.
#include "formats/place_precision.h"

#include <string>

#include "formats/byte_order.h"
#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;

/// The corners of a cube of that edge, as lines of x y z.
std::string corners(double x, double y, double z, double edge, const char* before = "") {
  std::string out;
  for (int corner = 0; corner < 8; ++corner) {
    out += before + std::to_string(x + (corner & 1) * edge) + " " +
           std::to_string(y + (corner >> 1 & 1) * edge) + " " + std::to_string(z + (corner >> 2) * edge) +
           "\n";
  }
  return out;
}

std::string ply_of(double x, double y, double z, double edge) {
  return "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 6\nproperty list uchar int vertex_indices\nend_header\n" +
         corners(x, y, z, edge) + "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
}

TEST(PlacePrecision, AMeshThatFloatWouldDestroyIsRefused) {
  EXPECT_EQ(line_of(read_mesh_bytes(ply_of(1e6, 2e6, 3e5, 0.1), "a.ply")),
            "a.ply: lies 2000 m from the origin, too far for its vertices to keep their places to a small "
            "part of their spacing; export it without the offset of a map or a room, or give its unit if "
            "that is what is wrong");
  EXPECT_THAT(line_of(read_mesh_bytes(corners(0, 0, -2e6, 0.1, "v ") + "f 1 3 4 2\nf 5 6 8 7\n", "a.obj")),
              HasSubstr("a.obj: lies 2000 m from the origin, too far for its vertices"));
  // All three corners fall onto one place.
  EXPECT_THAT(line_of(read_mesh_bytes("solid s\nfacet normal 0 0 1\nouter loop\nvertex 3000000 0 0\n"
                                      "vertex 3000000.01 0 0\nvertex 3000000.01 0.01 0\nendloop\nendfacet\n"
                                      "endsolid\n",
                                      "a.stl")),
              HasSubstr("a.stl: lies 3000 m from the origin"));
}

TEST(PlacePrecision, SoIsOneThatItsNodeMovesThere) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}};
  mesh.faces = {{0, 1, 2}};
  std::string glb = encode_mesh_glb(mesh, "t").value();
  const auto chunks = split_glb(glb, "t");
  ASSERT_TRUE(chunks);
  std::string json(chunks->json);
  json.insert(json.find("\"scale\""), "\"translation\":[0,900,0],");
  EXPECT_THAT(line_of(read_mesh_bytes(join_glb(json, std::string(chunks->binary)), "a.glb")),
              HasSubstr("a.glb: lies 900 m from the origin"));
}

TEST(PlacePrecision, WhatKeepsItsPlacesIsRead) {
  EXPECT_TRUE(read_mesh_bytes(ply_of(1e5, 2e5, 3e4, 1.0), "a.ply"));
  EXPECT_TRUE(read_mesh_bytes(ply_of(1e8, 2e8, 3e7, 500.0), "a.ply"));
  EXPECT_TRUE(read_mesh_bytes(ply_of(500, 0, 0, 1e-5), "a.ply"));
  // Points are only looked at, and have no spacing.
  EXPECT_TRUE(read_mesh_bytes("v 9000000 0 0\nv 9000001 0 0\n", "a.obj", {.may_be_points = true}));
  // In micrometres it lies near.
  EXPECT_TRUE(read_mesh_bytes(ply_of(1e6, 2e6, 3e5, 100.0), "a.ply", {.mm_per_unit = 1e-3}));
}

}  // namespace
}  // namespace dubsar
