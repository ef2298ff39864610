// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <array>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "tests/formats/format_support.h"
#include "tests/formats/tetrahedron.h"

namespace dubsar {
namespace {

using testing::line_of;
using testing::tetrahedron;

TEST(MeshGlb, AppliesNodeTransforms) {
  const std::string glb = encode_mesh_glb(tetrahedron(), "t").value();
  const GlbChunks chunks = split_glb(glb, "t").value();
  std::string json(chunks.json);
  const std::size_t nodes = json.find("\"nodes\": [\n  {");
  ASSERT_NE(nodes, std::string::npos);
  // A parent that mirrors x and shifts by 2 m; the child keeps its scale to millimetres.
  json.replace(nodes, 10, R"("nodes": [ {"children":[1],"scale":[-1,1,1],"translation":[2,0,0]}, )");
  const auto mesh = read_mesh_bytes(join_glb(json, std::string(chunks.binary)), "a.glb");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_NEAR(mesh->positions[1].x(), 1990, 1e-3);
  EXPECT_EQ(mesh->faces[0], (std::array<std::uint32_t, 3>{0, 1, 2})) << "a mirrored face keeps its outside";
}

TEST(MeshGlb, HasNoNormalThatIsNotOneLong) {
  Mesh mesh = tetrahedron();
  mesh.normals = vertex_normals(mesh);
  const Eigen::Vector3f right = mesh.normals[1];
  mesh.positions.emplace_back(9, 9, 9);  // no face has it
  mesh.normals.emplace_back(0, 0, 0);
  mesh.normals[1].setZero();
  mesh.normals[2].setConstant(std::numeric_limits<float>::quiet_NaN());
  const std::string glb = encode_mesh_glb(mesh, "t").value();
  const std::string_view binary = split_glb(glb, "t").value().binary;
  std::array<Eigen::Vector3f, 5> normals;  // behind as many positions
  ASSERT_GE(binary.size(), 2 * sizeof normals);
  std::memcpy(static_cast<void*>(normals.data()), binary.data() + sizeof normals, sizeof normals);
  for (const Eigen::Vector3f& n : normals) {
    EXPECT_NEAR(n.norm(), 1, 1e-6);
  }
  EXPECT_LT((normals[1] - right).norm(), 1e-6);
  EXPECT_EQ(normals[4], Eigen::Vector3f::UnitZ());
}

/// ISO/IEC 12113:2022, 3.9.6: what has no material is of the default one, which is metal.
TEST(MeshGlb, IsOfClayAndNotOfMetal) {
  for (const std::string& glb :
       {encode_mesh_glb(tetrahedron(), "t").value(), encode_mesh_draco_glb(tetrahedron(), "t").value()}) {
    const nlohmann::json json = nlohmann::json::parse(split_glb(glb, "t").value().json);
    const nlohmann::json& primitive = json["meshes"][0]["primitives"][0];
    ASSERT_TRUE(primitive.contains("material")) << primitive;
    const nlohmann::json& looks =
        json["materials"][primitive["material"].get<std::size_t>()]["pbrMetallicRoughness"];
    EXPECT_EQ(looks["metallicFactor"], 0.0);
    EXPECT_FALSE(looks.contains("baseColorFactor")) << "white: colours of vertices are multiplied by it";
  }
}

}  // namespace
}  // namespace dubsar
