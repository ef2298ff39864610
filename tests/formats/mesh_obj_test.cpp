// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/mesh_io.h"
#include "tests/formats/closed_surface.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;

TEST(MeshObj, ReadsWhatOthersWrite) {
  const auto mesh = read_mesh_bytes(
      "# c\r\nmtllib x\r\nv 0 0 0 0.5 0.5 0.5\r\nv 1 0 0\r\nvt 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1/1/1 2//2 3 "
      "-1\r\n",
      "a.obj");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshObj, ReadsLinesOfEveryKind) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  std::string macintosh = vertices + "f 1 2 3\nf 1 3 4\n";
  std::ranges::replace(macintosh, '\n', '\r');
  for (const std::string& text :
       {vertices + "f 1 2 3 4 # a face\n", "\xEF\xBB\xBF" + vertices + "f 1 2 3 4\n",
        vertices + "f 1 2 \\\n 3 4\n", vertices + "f 1 2 3\\\n4\n",
        "v 0 0\\\n 0\nv 1 \\\r\n0\\\r\n0\n" + vertices.substr(16) + "f 1 2 3 4\n", "f 1 2 3 4\n" + vertices,
        macintosh}) {
    SCOPED_TRACE(text);
    const auto mesh = read_mesh_bytes(text, "a.obj");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->positions.size(), 4U);
    EXPECT_EQ(mesh->faces, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(MeshObj, PolygonsNeedNotBeConvex) {
  for (int first = 0; first < 6; ++first) {  // an L, from each of its corners
    std::string text = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf";
    for (int k = 0; k < 6; ++k) {
      text += ' ';
      text += std::to_string((first + k) % 6 + 1);
    }
    const auto mesh = read_mesh_bytes(text, "a.obj");
    ASSERT_TRUE(mesh) << line_of(mesh);
    EXPECT_EQ(mesh->faces.size(), 4U);
    EXPECT_NEAR(surface_area_mm2(*mesh), 3.0, 1e-6) << first;
  }
}

TEST(MeshObj, AVertexWithoutAColourIsWhiteWhereverItStands) {
  const auto mesh =
      read_mesh_bytes("v 0 0 0\nv 1 0 0 200 100 50\nv 1 1 0\nv 0 1 0 10 20 30\nf 1 2 3\nf 1 3 4\n", "a.obj");
  ASSERT_TRUE(mesh) << line_of(mesh);
  using Colours = std::vector<std::array<std::uint8_t, 3>>;
  EXPECT_EQ(mesh->colours, (Colours{{255, 255, 255}, {200, 100, 50}, {255, 255, 255}, {10, 20, 30}}));
}

TEST(MeshHostile, Obj) {
  const auto line = [](const std::string& text) { return line_of(read_mesh_bytes(text, "a.obj")); };
  EXPECT_THAT(line("v 0 0 zero\n"), HasSubstr("a.obj: line 1: 'zero' is not a coordinate"));
  EXPECT_THAT(line("v 0 0 0\nf 1 2 1\n"), HasSubstr("line 2: '2' is not one of the 1 vertices"));
  EXPECT_THAT(line("v 0 0 0\nf 1 0 1\n"), HasSubstr("'0' is not one of"));
  EXPECT_THAT(line("v 0 0 0\nf -2\n"), HasSubstr("'-2' is not one of"));
  EXPECT_THAT(line("v 0 0 1e60\n"), HasSubstr("a position is not finite"));
  EXPECT_THAT(line("f 1 4294967295 2\n"), HasSubstr("line 1: '4294967295' is not one of"));
  EXPECT_THAT(line("v 0 0 0\nl 1 1\n"), HasSubstr("an OBJ file without faces"));
  EXPECT_THAT(line("a poem\n"), HasSubstr("not an OBJ mesh"));
}

}  // namespace
}  // namespace dubsar
