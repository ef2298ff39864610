// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Away from PLY and back: what is not known is not made up, and who did not make a mesh is not its maker.
#include "formats/mesh_losses.h"

#include "core/utf8.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "tests/formats/format_support.h"
#include "tests/formats/tetrahedron.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::line_of;
using ::testing::Not;
using testing::ScratchFolder;
using ::testing::StartsWith;
using testing::tetrahedron;

Mesh measured() {
  Mesh mesh = tetrahedron();
  mesh.reliability = {0, 0.25F, 0.5F, 1};
  mesh.sigma_mm = {0.5F, 0.01F, 0, 1e-6F};
  mesh.scans = {0, 1, 2, 255};
  mesh.flags = {1, 2, 4, 7};
  return mesh;
}

/// As `dubsar mesh convert` does it; the first mebibyte of the new file.
std::string converted(const fs::path& from, const fs::path& to) {
  const auto mesh = read_mesh(from);
  EXPECT_TRUE(mesh) << line_of(mesh);
  EXPECT_TRUE(mesh && write_mesh(to, *mesh, read_mesh_label(from)));
  return read_file_head(to, std::size_t{1} << 20U).value_or("");
}

TEST(MeshLosses, WhatIsNotKnownIsNotWritten) {
  const ScratchFolder folder;
  for (const char* name : {"a.obj", "a.stl", "a.glb"}) {
    ASSERT_TRUE(write_mesh(folder / name, measured()));
    const std::string ply = converted(folder / name, folder / "back.ply");
    EXPECT_EQ(ply.find("reliability"), std::string::npos) << name;
    const auto back = read_mesh(folder / "back.ply");
    ASSERT_TRUE(back) << line_of(back);
    EXPECT_EQ(back->positions.size(), 4U) << name;
    EXPECT_EQ(back->faces.size(), 4U) << name;
    EXPECT_TRUE(back->reliability.empty()) << name;
    EXPECT_TRUE(back->sigma_mm.empty()) << name;
    EXPECT_TRUE(back->scans.empty()) << name;
    EXPECT_TRUE(back->flags.empty()) << name;
  }
}

TEST(MeshLosses, CompressionLeavesOutWhatIsOfNoFaceAndSaysSo) {
  Mesh mesh = tetrahedron();
  mesh.positions.emplace_back(9, 9, 9);
  mesh.normals.clear();
  mesh.faces.push_back({0, 1, 1});
  const ScratchFolder folder;
  ASSERT_TRUE(write_mesh(folder / "a.draco.glb", mesh));
  const auto back = read_mesh(folder / "a.draco.glb");
  ASSERT_TRUE(back) << line_of(back);
  const LeftOut out = left_out_of(mesh, "a.draco.glb");
  EXPECT_EQ(back->positions.size(), mesh.positions.size() - out.vertices);
  EXPECT_EQ(back->faces.size(), mesh.faces.size() - out.faces);
  EXPECT_EQ(
      mesh_losses(mesh, "a.draco.glb", "keep a.ply")->what,
      "GLB holds no vertices without a face (1) or faces without three different corners (1): left out");
  EXPECT_FALSE(mesh_losses(mesh, "a.glb", "keep a.ply"));
}

TEST(MeshLosses, StlHasNoVerticesWithoutAFace) {
  Mesh mesh = tetrahedron();
  mesh.normals.clear();
  mesh.positions.emplace_back(9, 9, 9);
  const ScratchFolder folder;
  ASSERT_TRUE(write_mesh(folder / "a.stl", mesh));
  EXPECT_EQ(read_mesh(folder / "a.stl").value().positions.size(),
            mesh.positions.size() - left_out_of(mesh, "a.stl").vertices);
  EXPECT_EQ(mesh_losses(mesh, "a.stl", "keep a.ply")->what,
            "STL holds no vertices without a face (1): left out");
  mesh.faces.push_back({0, 1, 1});  // stays
  EXPECT_EQ(left_out_of(mesh, "a.stl").faces, 0U);
  EXPECT_FALSE(mesh_losses(mesh, "a.ply", "keep b.ply"));
}

std::vector<std::string> passed_over(const std::string& bytes, const std::string& name) {
  std::vector<std::string> names;
  const auto mesh = read_mesh_bytes(bytes, name, {.passed_over = &names});
  EXPECT_TRUE(mesh) << line_of(mesh);
  return names;
}

TEST(MeshLosses, WhatIsPassedOverIsNamedWhateverIsWritten) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
      "property float quality\nproperty float u\nproperty float v\nproperty float nx\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty float quality\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement material 0\nproperty int k\n"
      "end_header\n0 0 0 1 2 3 255 0.5 0 0 1\n1 0 0 1 2 3 255 0.5 0 1 1\n0 1 0 1 2 3 255 0.5 1 0 1\n"
      "3 0 1 2 7\n0 1\n";
  const std::vector<std::string> names = passed_over(ply, "a.ply");
  EXPECT_EQ(names, (std::vector<std::string>{"vertex alpha", "vertex quality", "texture coordinates",
                                             "vertex nx", "face quality", "edge"}));
  EXPECT_EQ(
      mesh_losses(tetrahedron(), "b.ply", "keep a.ply", names)->line(),
      "b.ply: what Dubsar does not read is left out: vertex alpha, vertex quality, texture coordinates, "
      "vertex nx, face quality and edge; keep a.ply");
  EXPECT_EQ(
      mesh_losses(measured(), "b.obj", "keep a.ply", std::vector<std::string>{"edge"})->what,
      "OBJ holds no reliability, sigma, scans or flags: left out, and what Dubsar does not read is left "
      "out: edge");
  EXPECT_EQ(passed_over(encode_mesh_ply(measured()), "a.ply"), std::vector<std::string>{});
  EXPECT_EQ(passed_over("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n", "a.obj"),
            std::vector<std::string>{kTextureCoordinates});
  const std::vector<std::string> many(12, std::string(200, 'q'));
  EXPECT_LT(mesh_losses(tetrahedron(), "b.ply", "keep a.ply", many)->line().size(), 600U);
}

TEST(MeshLosses, FlagsOfAnotherProgramAreNoMarks) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property int flags\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 256\n1 0 0 256\n0 1 0 256\n3 0 1 2\n";
  const auto mesh = read_mesh_bytes(ply, "a.ply");
  ASSERT_TRUE(mesh) << line_of(mesh);
  EXPECT_TRUE(mesh->flags.empty());
  EXPECT_EQ(passed_over(ply, "a.ply"), std::vector<std::string>{"vertex flags"});
}

TEST(MeshLosses, PlyHasEachOfThemByItself) {
  const Mesh all = measured();
  for (int only = 0; only < 4; ++only) {
    Mesh one = tetrahedron();
    one.reliability = only == 0 ? all.reliability : one.reliability;
    one.sigma_mm = only == 1 ? all.sigma_mm : one.sigma_mm;
    one.scans = only == 2 ? all.scans : one.scans;
    one.flags = only == 3 ? all.flags : one.flags;
    const auto back = read_mesh_bytes(encode_mesh_ply(one), "a.ply");
    ASSERT_TRUE(back) << line_of(back);
    EXPECT_EQ(back->reliability, one.reliability) << only;
    EXPECT_EQ(back->sigma_mm, one.sigma_mm) << only;
    EXPECT_EQ(back->scans, one.scans) << only;
    EXPECT_EQ(back->flags, one.flags) << only;
    EXPECT_EQ(back->faces, one.faces) << only;
  }
}

TEST(MeshLosses, AreNamedWhereThereAreAny) {
  Mesh mesh = measured();
  mesh.colours.resize(4);
  EXPECT_FALSE(mesh_losses(mesh, "a.ply", "keep b.ply"));
  EXPECT_FALSE(mesh_losses(mesh, "A.PLY", "keep b.ply"));
  const auto said = [&](const char* file) {
    const auto lost = mesh_losses(mesh, file, "keep b.ply");
    return lost ? lost->line() : std::string();
  };
  EXPECT_EQ(said("a.obj"), "a.obj: OBJ holds no reliability, sigma, scans or flags: left out; keep b.ply");
  EXPECT_EQ(said("a.GLB"), "a.GLB: GLB holds no reliability, sigma, scans or flags: left out; keep b.ply");
  EXPECT_THAT(said("a.stl"), HasSubstr("STL holds no reliability, sigma, scans, flags or colours: left out"));
  mesh.sigma_mm.clear();
  mesh.scans.clear();
  mesh.colours.clear();
  EXPECT_THAT(said("a.stl"), HasSubstr("STL holds no reliability or flags: left out"));
  mesh.reliability.clear();
  EXPECT_THAT(said("a.stl"), HasSubstr("STL holds no flags: left out"));
  mesh.flags.clear();
  mesh.normals.resize(4);
  EXPECT_EQ(said("a.stl"), "");
}

TEST(MeshOrigin, AMeshOfOthersSaysWhatItWasConvertedFrom) {
  const ScratchFolder folder;
  ASSERT_TRUE(
      write_file_atomically(folder / "bunny.obj", "# by another\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  EXPECT_THAT(converted(folder / "bunny.obj", folder / "a.ply"),
              HasSubstr("\ncomment Converted by Dubsar from bunny.obj\nobj_info unit mm\n"));
  EXPECT_THAT(converted(folder / "a.ply", folder / "b.obj"),
              StartsWith("# Converted by Dubsar from a.ply, millimetres\nv "));
  EXPECT_THAT(converted(folder / "b.obj", folder / "c.stl"), StartsWith("Written by Dubsar, millimetres "));
  EXPECT_THAT(converted(folder / "c.stl", folder / "d.ply"),
              HasSubstr("\ncomment Converted by Dubsar from c.stl\n"));
  (void)converted(folder / "d.ply", folder / "e.glb");
  EXPECT_THAT(converted(folder / "e.glb", folder / "f.ply"),
              HasSubstr("\ncomment Converted by Dubsar from e.glb\n"));
  EXPECT_TRUE(read_file_label(folder / "f.ply").empty());
  EXPECT_EQ(read_mesh_label(folder / "none.ply").origin, "Converted by Dubsar from none.ply");
}

TEST(MeshOrigin, AMeshOfDubsarStaysOne) {
  const ScratchFolder folder;
  const FileLabel label = label_of_words({{"Museum number", "BM 12345"}});
  for (const FileLabel& said : {FileLabel{}, label}) {
    for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb"}) {
      if (said.empty() && fs::path(name).extension() == ".glb") {
        continue;  // its generator says who wrote it, and no word who made it
      }
      ASSERT_TRUE(write_mesh(folder / name, measured(), said));
      EXPECT_THAT(converted(folder / name, folder / "b.ply"), HasSubstr("\ncomment Mesh of Dubsar\n"))
          << name;
    }
  }
}

TEST(MeshOrigin, AFilesNameBreaksNoHeader) {
  for (const std::string& name : {std::string("a\nend_header\n.ply"), std::string("\xff\xc3.ply"),
                                  "ä" + std::string(3000, 'x'), "x" + std::string(3000, '\xe4')}) {
    const FileLabel label{.origin = "Converted by Dubsar from " + name};
    const std::string ply = encode_mesh_ply(tetrahedron(), label);
    const std::string head = ply.substr(0, ply.find("end_header\n"));
    EXPECT_THAT(head, HasSubstr("element face 4"));
    EXPECT_THAT(head, HasSubstr("comment Converted by Dubsar from "));
    EXPECT_EQ(as_utf8(head), head);
    for (std::size_t at = 0; at < head.size(); at = head.find('\n', at) + 1) {
      EXPECT_LE(head.find('\n', at) - at, kMaxLabelLineBytes);
    }
    EXPECT_TRUE(read_mesh_bytes(ply, "a.ply"));
    EXPECT_TRUE(read_mesh_bytes(encode_mesh_obj(tetrahedron(), label), "a.obj"));
  }
}

}  // namespace
}  // namespace dubsar
