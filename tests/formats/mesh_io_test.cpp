// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/mesh_io.h"

#include <algorithm>

#include "formats/byte_order.h"
#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "formats/ply_header.h"
#include "tests/formats/closed_surface.h"
#include "tests/formats/format_support.h"
#include "tests/formats/tetrahedron.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::is_closed_and_oriented;
using testing::line_of;
using testing::ScratchFolder;
using testing::tetrahedron;

Mesh full_mesh() {
  Mesh mesh = tetrahedron();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6F, 0, 0.8F}};
  mesh.reliability = {0, 0.25F, 0.5F, 1};
  mesh.sigma_mm = {0.5F, 0.01F, 0, 1e-6F};
  mesh.scans = {0, 1, 2, 255};
  mesh.flags = {1, 2, 4, 7};
  mesh.colours = {{{1, 2, 3}}, {{4, 5, 6}}, {{7, 8, 9}}, {{255, 0, 128}}};
  return mesh;
}

TEST(MeshIo, PlyKeepsEverythingToTheBit) {
  const ScratchFolder folder;
  const Mesh mesh = full_mesh();
  ASSERT_TRUE(write_mesh(folder / "a.ply", mesh));
  const auto back = read_mesh(folder / "a.ply");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->positions, mesh.positions);
  EXPECT_EQ(back->faces, mesh.faces);
  EXPECT_EQ(back->normals, mesh.normals);
  EXPECT_EQ(back->reliability, mesh.reliability);
  EXPECT_EQ(back->sigma_mm, mesh.sigma_mm);
  EXPECT_EQ(back->scans, mesh.scans);
  EXPECT_EQ(back->flags, mesh.flags);
  EXPECT_EQ(back->colours, mesh.colours);
}

TEST(MeshIo, PlyHasTheHeaderOfTheContract) {
  Mesh stitched = full_mesh();
  stitched.sigma_mm.clear();
  stitched.colours.clear();
  const std::string bytes = encode_mesh_ply(stitched);
  EXPECT_EQ(
      bytes.substr(0, bytes.find("end_header")),
      "ply\nformat binary_little_endian 1.0\ncomment Mesh of Dubsar\nobj_info unit mm\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nproperty float reliability\nproperty uchar scans\nproperty uchar flags\n"
      "element face 4\nproperty list uchar int vertex_indices\n");
}

TEST(MeshIo, EveryFormatKeepsTheSurface) {
  const ScratchFolder folder;
  const Mesh mesh = tetrahedron();
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb", "A.GLB"}) {
    ASSERT_TRUE(write_mesh(folder / name, mesh)) << name;
    const auto back = read_mesh(folder / name);
    ASSERT_TRUE(back) << line_of(back);
    EXPECT_EQ(back->faces.size(), 4U) << name;
    EXPECT_TRUE(is_closed_and_oriented(*back)) << name;
    ASSERT_EQ(back->positions.size(), 4U) << name;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(back->positions[back->faces[2][k]], mesh.positions[mesh.faces[2][k]]) << name;
    }
  }
  EXPECT_THAT(line_of(write_mesh(folder / "a.off", mesh)), HasSubstr("use .ply, .obj, .stl or .glb"));
}

TEST(MeshIo, ACancelledJobReadsAndWritesNothing) {
  const ScratchFolder folder;
  JobContext job;
  job.cancel();
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb"}) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(write_mesh(folder / name, full_mesh()));
    const std::string before = read_whole_file(folder / name).value();
    const auto read = read_mesh(folder / name, {.job = &job});
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().kind, ErrorKind::kCancelled);
    const Status written = write_mesh(folder / name, tetrahedron(), {}, &job);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(read_whole_file(folder / name).value(), before);
  }
}

TEST(MeshIo, UnitsScale) {
  const auto ply = read_mesh_bytes(encode_mesh_ply(tetrahedron()), "a.ply", {.mm_per_unit = 1000.0});
  EXPECT_EQ(ply.value().positions[1].x(), 10000);
  const auto glb =
      read_mesh_bytes(encode_mesh_glb(tetrahedron(), "t").value(), "a.glb", {.mm_per_unit = 1.0});
  EXPECT_NEAR(glb.value().positions[1].x(), 0.01, 1e-9);
}

const std::string kSquare =
    "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty uchar other\n"
    "element face 1\nproperty list int short vertex_index\nend_header\n";

TEST(MeshPly, ReadsForeignAsciiAndTriangulatesPolygons) {
  const std::string text =
      "ply\nformat ascii 1.0\n" + kSquare + "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n";
  const auto mesh = read_mesh_bytes(text, "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(mesh->normals.empty());
}

TEST(MeshPly, NamesMayBeInCapitals) {
  const auto mesh = read_mesh_bytes(
      "ply\nformat ascii 1.0\nelement Vertex 3\nproperty float X\nproperty float Y\nproperty float Z\n"
      "property uchar Red\nproperty uchar Green\nproperty uchar Blue\nelement FACE 1\n"
      "property list uchar int Vertex_Indices\nend_header\n0 0 0 9 8 7\n1 0 0 9 8 7\n0 1 0 9 8 7\n3 0 1 2\n",
      "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
  EXPECT_EQ(mesh->colours[2], (std::array<std::uint8_t, 3>{9, 8, 7}));
}

TEST(MeshPly, LinesMayEndAsOnAnOldMacintosh) {
  for (const std::string& ending : {std::string("\r"), std::string("\r\n")}) {
    std::string text = encode_mesh_ply(tetrahedron());
    const std::size_t head = text.find("end_header\n") + 11;
    std::string lines = text.substr(0, head);
    for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos; at += ending.size()) {
      lines.replace(at, 1, ending);
    }
    const auto mesh = read_mesh_bytes(lines + text.substr(head), "a.ply");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->positions, tetrahedron().positions);
    EXPECT_EQ(mesh->faces, tetrahedron().faces);
  }
}

TEST(MeshPly, ReadsTriangleStrips) {
  const auto mesh = read_mesh_bytes(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n10 0 1 2 3 -1 1 4 4 3 2\n",
      "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 1, 3}, {4, 3, 2}}));
}

TEST(MeshPly, FacesOfOneOrTwoCornersStayAsFaults) {
  const auto mesh = read_mesh_bytes(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n1 2\n2 0 1\n",
      "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 2, 2}, {0, 1, 1}}));
}

TEST(MeshPly, ReadsBigEndian) {
  std::string text = "ply\nformat binary_big_endian 1.0\n" + kSquare;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    for (const double v : {x, y, 0.0}) {
      append(text, v, std::endian::big);
    }
    text += 'o';
  }
  append(text, std::int32_t{4}, std::endian::big);
  for (const std::int16_t i : {0, 1, 2, 3}) {
    append(text, i, std::endian::big);
  }
  const auto mesh = read_mesh_bytes(text, "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces.size(), 2U);
  EXPECT_EQ(mesh->positions[2], Eigen::Vector3f(1, 1, 0));
}

TEST(MeshPly, SidesOfATextureSeamAreOneSurface) {
  // A tetrahedron whose last face lies apart in the texture, as Blender writes it: three places stand twice.
  const auto ply = [](const char* s, const char* t) {
    return std::string("ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\n") +
           "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n" +
           "property uchar green\nproperty uchar blue\nproperty float " + s + "\nproperty float " + t +
           "\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 0 0 1 10 0 0 0 0\n1 0 0 0 0 1 20 0 0 1 0\n0 1 0 0 0 1 30 0 0 0 1\n"
           "1 0 0 1 0 0 21 0 0 0.5 0.5\n-0 1 0 1 0 0 31 0 0 0.6 0.5\n0 0 1 0 0 1 40 0 0 0.5 0.6\n"
           "0 0 1 1 0 0 41 0 0 0.7 0.7\n"
           "3 0 2 1\n3 0 1 5\n3 0 5 2\n3 3 4 6\n";
  };
  for (const auto& [s, t] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const auto mesh = read_mesh_bytes(ply(s, t), "a.ply");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->positions.size(), 4U);
    EXPECT_EQ(mesh->faces.size(), 4U);
    EXPECT_TRUE(is_closed_and_oriented(*mesh));
    EXPECT_TRUE(mesh->normals.empty());
    EXPECT_EQ(mesh->colours, (std::vector<std::array<std::uint8_t, 3>>{{10}, {20}, {30}, {40}}));
  }
  // Nothing says that such places of other meshes are one: a pinched vertex that was split stays so.
  const auto other = read_mesh_bytes(ply("quality", "radius"), "a.ply");
  ASSERT_TRUE(other) << line_of(other);
  EXPECT_EQ(other->positions.size(), 7U);
  EXPECT_EQ(other->normals.size(), 7U);
}

/// A band of triangles that many rows are read of at a time.
Mesh long_band() {
  Mesh mesh;
  for (std::uint32_t v = 0; v < 150000; ++v) {
    mesh.positions.emplace_back(0.01F * static_cast<float>(v), static_cast<float>(v % 2), 0.3F);
    mesh.reliability.push_back(static_cast<float>(v % 7) / 7);
    mesh.flags.push_back(static_cast<std::uint8_t>(v % 5));
    if (v > 1) {
      mesh.faces.push_back({v - 2, v - 1, v});
    }
  }
  mesh.scans.resize(mesh.positions.size(), 3);
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

TEST(MeshPly, ManyAtOnceAreReadAsOneByOne) {
  const Mesh mesh = long_band();
  const std::string bytes = encode_mesh_ply(mesh);
  const std::string more_faces = "element face " + std::to_string(mesh.faces.size() + 1) + "\n";
  std::string with_quad = bytes;
  const std::string counted = "element face " + std::to_string(mesh.faces.size()) + "\n";
  with_quad.replace(with_quad.find(counted), counted.size(), more_faces);
  append(with_quad, std::uint8_t{4});
  for (const std::uint32_t v : {0U, 1U, 2U, 3U}) {
    append(with_quad, v);
  }
  const auto at_once = read_mesh_bytes(bytes, "a.ply");
  const auto one_by_one = read_mesh_bytes(with_quad, "a.ply");
  ASSERT_TRUE(at_once) << line_of(at_once);
  ASSERT_TRUE(one_by_one) << line_of(one_by_one);
  EXPECT_EQ(at_once->positions, mesh.positions);
  EXPECT_EQ(at_once->normals, mesh.normals);
  EXPECT_EQ(at_once->reliability, mesh.reliability);
  EXPECT_EQ(at_once->flags, mesh.flags);
  EXPECT_EQ(at_once->faces, mesh.faces);
  ASSERT_EQ(one_by_one->faces.size(), mesh.faces.size() + 2);
  EXPECT_TRUE(std::equal(mesh.faces.begin(), mesh.faces.end(), one_by_one->faces.begin()));
}

TEST(MeshHostile, WhatIsWrongAmongManyPlyRowsIsNamed) {
  const Mesh mesh = long_band();
  const std::string bytes = encode_mesh_ply(mesh);
  constexpr std::size_t kVertexBytes = 7 * 4 + 2;
  constexpr std::size_t kFaceBytes = 13;
  const std::size_t faces_at = bytes.size() - mesh.faces.size() * kFaceBytes;
  const std::size_t vertices_at = faces_at - mesh.positions.size() * kVertexBytes;
  const auto with = [&](std::size_t at, std::string_view put) {
    std::string broken = bytes;
    broken.replace(at, put.size(), put);
    return line_of(read_mesh_bytes(broken, "a.ply"));
  };
  EXPECT_THAT(with(vertices_at + 140001 * kVertexBytes, std::string_view("\0\0\xc0\x7f", 4)),
              HasSubstr("vertex 140001: its position is not finite"));
  EXPECT_THAT(with(faces_at + 130002 * kFaceBytes + 5, "\xff\xff\xff\xff"),
              HasSubstr("face 130002: vertex index -1 is not one of the 150000 vertices"));
  EXPECT_THAT(with(faces_at + 149997 * kFaceBytes, "\x04"), HasSubstr("ends within face 149997 of 149998"));
}

TEST(MeshHostile, Ply) {
  const auto ascii = [](const std::string& body) {
    return line_of(read_mesh_bytes("ply\nformat ascii 1.0\n" + kSquare + body, "a.ply"));
  };
  EXPECT_THAT(ascii("0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 4\n"),
              HasSubstr("a.ply: face 0 (line 15): vertex index 4 is not one of the 4 vertices"));
  EXPECT_THAT(ascii("0 0 0 9\n1 0 nan 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n"),
              HasSubstr("vertex 1 (line 12): its position is not finite"));
  EXPECT_THAT(ascii("0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n9999 0 1 2 3\n"),
              HasSubstr("'0' is not what belongs here"));
  EXPECT_THAT(ascii("0 0 0 9\n"), HasSubstr("claims 4 of element vertex"));
  EXPECT_THAT(line_of(read_mesh_bytes(
                  "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n", "a.ply")),
              HasSubstr("a PLY file without faces; give a mesh; scans become one with dubsar stitch"));
  for (const char* corners : {"", "2 0 0\n"}) {  // none; one that is no polygon
    const std::string empty =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face " +
        std::string(*corners == '\0' ? "0" : "1") +
        "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n" + corners;
    EXPECT_THAT(line_of(read_mesh_bytes(empty, "a.ply")), HasSubstr("a PLY file without faces")) << corners;
    EXPECT_TRUE(read_mesh_bytes(empty, "a.ply", {.may_be_points = true})) << corners;
  }
  EXPECT_THAT(line_of(read_mesh_bytes("", "a.ply")), HasSubstr("a.ply: the file is empty"));
  EXPECT_THAT(line_of(read_mesh_bytes("hello", "a.doc")), HasSubstr("not a mesh that Dubsar reads"));
  const std::string whole = encode_mesh_ply(full_mesh());
  for (std::size_t size = 1; size < whole.size(); ++size) {
    EXPECT_FALSE(read_mesh_bytes(whole.substr(0, size), "a.ply")) << size;
  }
}

TEST(MeshStl, ReadsAscii) {
  const auto mesh = read_mesh_bytes(
      "solid s\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n endloop\n "
      "endfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex -0.0 1 "
      "0\nendloop\nendfacet\nendsolid\n",
      "a.stl");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->positions.size(), 4U);
  EXPECT_EQ(mesh->faces.size(), 2U);
}

TEST(MeshPly, AByteOrderMarkIsPassedOver) {
  const std::string text =
      "ply\nformat ascii 1.0\nobj_info unit m\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n0.01 0 0\n0 0.01 0\n3 0 1 2\n";
  std::string macintosh = text;
  std::ranges::replace(macintosh, '\n', '\r');
  for (const std::string& lines : {text, macintosh}) {
    const std::string marked = "\xEF\xBB\xBF" + lines;
    const auto mesh = read_mesh_bytes(marked, "a.ply");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->faces.size(), 1U);
    EXPECT_FLOAT_EQ(mesh->positions[1].x(), 10);
    EXPECT_TRUE(states_unit(marked, "a.ply"));
  }
}

TEST(MeshStl, ReadsAsciiOfEveryKind) {
  const std::string plain =
      "solid facts\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid vertex\n";
  std::string upper = plain;
  std::ranges::transform(upper, upper.begin(),
                         [](char c) { return c >= 'a' ? static_cast<char>(c - 32) : c; });
  std::string one_line = plain;
  std::ranges::replace(one_line, '\n', ' ');
  std::string macintosh = plain;
  std::ranges::replace(macintosh, '\n', '\r');
  for (const std::string& text :
       {plain, upper, one_line, macintosh, " \n " + plain, "\xEF\xBB\xBF" + plain}) {
    SCOPED_TRACE(text);
    const auto mesh = read_mesh_bytes(text, "a.stl");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->positions.size(), 4U);
    EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  }
  EXPECT_THAT(line_of(read_mesh_bytes(plain.substr(0, plain.size() - 18), "a.stl")),
              HasSubstr("no endsolid"));
}

TEST(MeshStl, BinaryMayBeginWithSolid) {
  std::string binary = encode_mesh_stl(tetrahedron());
  std::ranges::copy(std::string_view("solid binary"), binary.begin());
  EXPECT_TRUE(read_mesh_bytes(binary, "a.stl"));
  EXPECT_TRUE(read_mesh_bytes(binary + "\n\n", "a.stl"));
  EXPECT_THAT(line_of(read_mesh_bytes(binary.substr(0, binary.size() - 60), "a.stl")),
              HasSubstr("claims 4 facets, but holds 2"));
}

TEST(MeshHostile, Stl) {
  const std::string whole = encode_mesh_stl(tetrahedron());
  EXPECT_THAT(line_of(read_mesh_bytes(whole.substr(0, whole.size() - 1), "a.stl")),
              HasSubstr("a.stl: claims 4 facets, but holds 3"));
  EXPECT_THAT(line_of(read_mesh_bytes("short", "a.stl")), HasSubstr("ends within its STL header"));
  EXPECT_THAT(line_of(read_mesh_bytes("solid\nvertex 0 0 0\n", "a.stl")), HasSubstr("ends within a facet"));
  EXPECT_THAT(line_of(read_mesh_bytes("solid\nvertex 0 0 x\n", "a.stl")),
              HasSubstr("line 2: 'x' is not a coordinate"));
}

TEST(MeshHostile, Glb) {
  const std::string whole = encode_mesh_glb(full_mesh(), "t").value();
  for (std::size_t size = 1; size < whole.size(); ++size) {
    EXPECT_FALSE(read_mesh_bytes(whole.substr(0, size), "a.glb")) << size;
  }
  const GlbChunks chunks = split_glb(whole, "t").value();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string json(chunks.json);
    const std::size_t at = json.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    json.replace(at, from.size(), to);
    return line_of(read_mesh_bytes(join_glb(json, std::string(chunks.binary)), "a.glb"));
  };
  EXPECT_THAT(with("\"count\": 4", "\"count\": 4000000000"),
              HasSubstr("accessors[0] does not fit into its buffer view"));
  EXPECT_THAT(with("\"count\": 4", "\"count\": -4"), HasSubstr("accessors[0].count is -4, out of range"));
  EXPECT_THAT(with("\"byteLength\": 48", "\"byteLength\": 48000"),
              HasSubstr("bufferViews[0] reaches beyond the"));
  EXPECT_THAT(with("\"bufferView\": 0", "\"bufferView\": 70"), HasSubstr("bufferViews[70] is missing"));
  EXPECT_THAT(with("\"mesh\": 0", "\"mesh\": 0, \"children\": [0]"),
              HasSubstr("is the child of more than one node"));
  EXPECT_THAT(with("\"mode\": 4", "\"mode\": 5"), HasSubstr("mode is a strip or fan"));
  EXPECT_THAT(with("\"scene\": 0", "\"extensionsRequired\": [\"EXT_meshopt_compression\"]"),
              HasSubstr("is EXT_meshopt_compression: meshes compressed so are not read"));
  EXPECT_THAT(with("\"scene\": 0", "\"extensionsRequired\": [\"ACME_warped_positions\"]"),
              HasSubstr("extensionsRequired[0] is ACME_warped_positions, which is not known"));
  EXPECT_EQ(with("\"scene\": 0", "\"extensionsRequired\": [\"KHR_materials_unlit\"]"), "no error");
  EXPECT_THAT(with("\"count\": 12", "\"count\": 11"),
              HasSubstr("has 11 corners, which are no whole triangles"));
  std::string broken_index = whole;
  broken_index[broken_index.size() - 1] = '\x7f';
  EXPECT_THAT(line_of(read_mesh_bytes(broken_index, "a.glb")),
              HasSubstr("meshes[0].primitives[0] has a vertex index beyond its 4 vertices: face 3"));
  std::string old = whole;
  old[4] = 1;
  EXPECT_THAT(line_of(read_mesh_bytes(old, "a.glb")), HasSubstr("glTF version 1 is not read"));
}

}  // namespace
}  // namespace dubsar
