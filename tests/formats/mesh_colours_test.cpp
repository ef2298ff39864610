// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a mesh carries beside its shape, as others write it: colours and normals of its vertices.
#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "formats/byte_order.h"
#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using Colours = std::vector<std::array<std::uint8_t, 3>>;

/// A row of triangles that has every byte as a colour.
Mesh colourful_mesh() {
  Mesh mesh;
  for (int i = 0; i < 258; ++i) {
    mesh.positions.emplace_back(static_cast<float>(i / 2), static_cast<float>(i % 2), 0.0F);
    const auto byte = static_cast<std::uint8_t>(i % 256);
    mesh.colours.push_back({byte, static_cast<std::uint8_t>(255 - byte), 128});
  }
  for (std::uint32_t i = 0; i + 2 < 258; ++i) {
    mesh.faces.push_back({i, i + 1, i + 2});
  }
  return mesh;
}

std::string ply_with(const std::string& properties, const std::vector<std::string>& values) {
  const std::vector<std::string> places = {"0 0 0 ", "1 0 0 ", "0 1 0 "};
  std::string out =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
      properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t v = 0; v < 3; ++v) {
    out += places[v] + values[v] + "\n";
  }
  return out + "3 0 1 2\n";
}

std::string colour_properties(const std::string& type) {
  return "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n";
}

TEST(MeshColours, GlbKeepsEachByte) {
  const Mesh mesh = colourful_mesh();
  const auto back = read_mesh_bytes(encode_mesh_glb(mesh, "t").value(), "a.glb");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->colours, mesh.colours);
}

TEST(MeshColours, ThoseOfGlbAreLinear) {
  Mesh mesh = colourful_mesh();
  mesh.colours.assign(mesh.colours.size(), {188, 0, 255});
  const std::string glb = encode_mesh_glb(mesh, "t").value();
  const GlbChunks chunks = split_glb(glb, "t").value();
  const std::size_t at = mesh.positions.size() * 12;
  // Half of the light is 188 of 255.
  EXPECT_NEAR(load<std::uint16_t>(chunks.binary.data() + at) / 65535.0, 0.5, 0.005);
  EXPECT_EQ(load<std::uint16_t>(chunks.binary.data() + at + 2), 0);
  EXPECT_EQ(load<std::uint16_t>(chunks.binary.data() + at + 4), 65535);
}

TEST(MeshColours, GlbOfOthersMayHaveFloatsAndPartsWithoutColours) {
  std::string binary;
  for (const float number : {0.F,  0.F, 0.F, 1.F,  0.F, 0.F, 0.F,  1.F, 0.F,     // places
                             0.F,  0.F, 5.F, 1.F,  0.F, 5.F, 0.F,  1.F, 5.F,     // of the second part
                             0.5F, 0.F, 1.F, 0.5F, 2.F, 1.F, 0.5F, 0.F, 1.F}) {  // colours
    append(binary, number);
  }
  const auto json_with = [](const std::string& count) {
    return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[0.001,0.001,0.001]}],"meshes":[{"primitives":[
      {"attributes":{"POSITION":1}},{"attributes":{"POSITION":0,"COLOR_0":2}},{"attributes":{"POSITION":1}}]}],
      "buffers":[{"byteLength":108}],"bufferViews":[{"buffer":0,"byteLength":108}],"accessors":[
      {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":0,"byteOffset":72,"componentType":5126,"count":)" +
           count + R"(,"type":"VEC3"}]})";
  };
  const auto mesh = read_mesh_bytes(join_glb(json_with("3"), binary), "a.glb");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(
      mesh->colours,
      (Colours{
          {255, 255, 255}, {255, 255, 255}, {255, 255, 255}, {188, 0, 255}, {188, 255, 255}, {188, 0, 255}}));
  EXPECT_THAT(line_of(read_mesh_bytes(join_glb(json_with("2"), binary), "a.glb")),
              HasSubstr("COLOR_0 has not as many colours as there are positions"));
}

TEST(MeshColours, ObjHasThemBehindThePlaces) {
  const auto colours = [](const std::string& vertices) {
    return read_mesh_bytes(vertices + "f 1 2 3\n", "a.obj").value().colours;
  };
  EXPECT_EQ(colours("v 0 0 0 1 0 0.015686\nv 1 0 0 0 0.5 0.003922\nv 0 1 0 0 0 0\n"),
            (Colours{{255, 0, 4}, {0, 128, 1}, {0, 0, 0}}));
  EXPECT_EQ(colours("v 0 0 0 255 0 4\nv 1 0 0 0 128 1\nv 0 1 0 0 0 0\n"),
            (Colours{{255, 0, 4}, {0, 128, 1}, {0, 0, 0}}));
  EXPECT_EQ(colours("v 0 0 0\nv 1 0 0 0 0.5 1\nv 0 1 0 1.0\n"),
            (Colours{{255, 255, 255}, {0, 128, 255}, {255, 255, 255}}));
  EXPECT_TRUE(colours("v 0 0 0 1.0\nv 1 0 0\nv 0 1 0\n").empty());
}

TEST(MeshColours, ObjKeepsEachByte) {
  const Mesh mesh = colourful_mesh();
  const std::string text = encode_mesh_obj(mesh);
  const auto back = read_mesh_bytes(text, "a.obj");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->colours, mesh.colours);
  // Others cut off what is behind the point.
  std::istringstream lines(text.substr(text.find("\nv ") + 1));
  for (std::size_t v = 0; v < mesh.colours.size(); ++v) {
    std::string keyword;
    std::array<float, 6> numbers{};
    lines >> keyword;
    for (float& number : numbers) {
      lines >> number;
    }
    ASSERT_EQ(keyword, "v");
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(numbers[3 + k], 1.0F);
      EXPECT_EQ(static_cast<int>(numbers[3 + k] * 255.0F), int{mesh.colours[v][k]});
    }
  }
}

TEST(MeshColours, ObjWithoutAnyHasThreeNumbersAVertex) {
  Mesh mesh = colourful_mesh();
  mesh.colours.clear();
  EXPECT_THAT(encode_mesh_obj(mesh), HasSubstr("v 0 1 0\nv 1 0 0\n"));
}

TEST(MeshColours, FloatsOfPlyMayRunTo255) {
  const std::vector<std::string> values = {"0.25 1 0", "0.5 nan -1", "254.6 7 inf"};
  for (const char* type : {"float", "double"}) {
    const auto mesh = read_mesh_bytes(ply_with(colour_properties(type), values), "a.ply");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->colours, (Colours{{0, 1, 0}, {1, 0, 0}, {255, 7, 255}}));
  }
  // Only the last vertex of many tells, whichever part of the file is read first.
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 200000\nproperty float x\nproperty float "
      "y\nproperty "
      "float z\n" +
      colour_properties("float") + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int v = 0; v < 200000; ++v) {
    const float colour = v == 199999 ? 200.0F : 1.0F;
    for (const float number : {static_cast<float>(v), static_cast<float>(v % 2), 0.0F, colour, 0.0F, 0.0F}) {
      append(binary, number);
    }
  }
  append(binary, std::uint8_t{3});
  for (const std::uint32_t corner : {0U, 1U, 2U}) {
    append(binary, corner);
  }
  const auto large = read_mesh_bytes(binary, "a.ply");
  ASSERT_TRUE(large) << line_of(large);
  EXPECT_EQ(large->colours.front()[0], 1);
  EXPECT_EQ(large->colours.back()[0], 200);
}

TEST(MeshColours, PlyHasThemOfSeveralTypes) {
  const auto colours = [](const std::string& type, const std::vector<std::string>& values) {
    return read_mesh_bytes(ply_with(colour_properties(type), values), "a.ply").value().colours;
  };
  EXPECT_EQ(colours("ushort", {"65535 32768 0", "257 0 514", "0 0 65278"}),
            (Colours{{255, 128, 0}, {1, 0, 2}, {0, 0, 254}}));
  EXPECT_EQ(colours("float", {"1 0.015686 0", "0.5 nan -1", "1.2 0 0.003922"}),
            (Colours{{255, 4, 0}, {128, 0, 0}, {255, 0, 1}}));
  EXPECT_EQ(colours("uchar", {"255 4 0", "3 2 1", "128 127 126"}),
            (Colours{{255, 4, 0}, {3, 2, 1}, {128, 127, 126}}));
  EXPECT_EQ(colours("int", {"255 4 0", "300 -2 1", "128 127 126"}),
            (Colours{{255, 4, 0}, {255, 0, 1}, {128, 127, 126}}));
}

TEST(MeshColours, PlyMayCallThemDiffuse) {
  std::string properties = colour_properties("uchar");
  for (const char* name : {" red", " green", " blue"}) {
    properties.replace(properties.find(name), 1, " diffuse_");
  }
  EXPECT_EQ(
      read_mesh_bytes(ply_with(properties, {"255 4 0", "3 2 1", "128 127 126"}), "a.ply").value().colours,
      (Colours{{255, 4, 0}, {3, 2, 1}, {128, 127, 126}}));
}

TEST(MeshNormals, AreUnitVectorsWhateverTheFileHas) {
  const auto mesh = read_mesh_bytes(ply_with("property float nx\nproperty float ny\nproperty float nz\n",
                                             {"0 0 5", "nan 0 1", "0 0.0003 0.0004"}),
                                    "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->normals[0], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(mesh->normals[1], Eigen::Vector3f(0, 0, 0));
  EXPECT_NEAR((mesh->normals[2] - Eigen::Vector3f(0, 0.6F, 0.8F)).norm(), 0, 1e-6);
}

}  // namespace
}  // namespace dubsar
