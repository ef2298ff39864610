// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a mesh says of itself, in every format.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/utf8.h"
#include "formats/file_label_reader.h"
#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "tests/formats/format_support.h"
#include "tests/formats/tetrahedron.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::ScratchFolder;
using testing::tetrahedron;

FileLabel label_of_bm_12345() {
  return {.name = "P123456, BM 12345",
          .rights = "© A Museum; CC BY 4.0",
          .simulated = true,
          .words = {{"SIMULATED", "No such tablet."},
                    {"Museum number", "BM 12345"},
                    {"Rights", "© A Museum; CC BY 4.0"}}};
}

TEST(MeshLabel, EveryFormatSaysWhatItIsOf) {
  const Mesh mesh = tetrahedron();
  const FileLabel label = label_of_bm_12345();
  EXPECT_THAT(
      encode_mesh_ply(mesh, label),
      HasSubstr("comment Mesh of Dubsar\ncomment SIMULATED: No such tablet.\ncomment Museum number: BM "
                "12345\ncomment Rights: © A Museum; CC BY 4.0\nobj_info unit mm\n"));
  EXPECT_THAT(encode_mesh_obj(mesh, label),
              HasSubstr("\n# Museum number: BM 12345\n# Rights: © A Museum; CC BY 4.0\nv "));
  EXPECT_EQ(encode_mesh_stl(mesh, label).substr(0, 80),
            "Dubsar, mm; SIMULATED; P123456, BM 12345; (c) A Museum; CC BY 4.0               ");
  const std::string glb = encode_mesh_glb(mesh, "a.glb", label).value();
  const auto json = nlohmann::json::parse(split_glb(glb, "a.glb").value().json);
  EXPECT_EQ(json["asset"]["copyright"], "© A Museum; CC BY 4.0");
  EXPECT_EQ(json["asset"]["extras"]["Museum number"], "BM 12345");
  EXPECT_EQ(json["asset"]["extras"]["SIMULATED"], "No such tablet.");
  EXPECT_EQ(json["nodes"][0]["name"], "P123456, BM 12345");
  EXPECT_EQ(json["meshes"][0]["name"], "P123456, BM 12345");
}

TEST(MeshLabel, IsHandedOnFromFormatToFormat) {
  const Mesh mesh = tetrahedron();
  const std::string rights = "© A Museum; " + std::string(300, 'r') + " and  blanks " + std::string(300, 's');
  const FileLabel label = label_of_words({{"SIMULATED", "No such tablet."},
                                          {"Museum number", "BM 12345"},
                                          {"CDLI number", "P123456"},
                                          {"Rights", rights}});
  EXPECT_EQ(label.name, "P123456, BM 12345");
  EXPECT_EQ(label.rights, rights);
  for (const std::string& bytes : {encode_mesh_ply(mesh, label), encode_mesh_obj(mesh, label),
                                   encode_mesh_glb(mesh, "a.glb", label).value()}) {
    const FileLabel back = file_label_in(bytes);
    EXPECT_EQ(back.name, label.name);
    EXPECT_EQ(back.rights, label.rights);
    EXPECT_TRUE(back.simulated);
    EXPECT_THAT(back.words, ::testing::UnorderedElementsAreArray(label.words));
  }
  const std::string stl = encode_mesh_stl(mesh, label);
  EXPECT_EQ(encode_mesh_stl(mesh, file_label_in(stl)), stl);
  // Of others nothing is taken for ours.
  for (const std::string& bytes :
       {encode_mesh_ply(mesh), encode_mesh_obj(mesh), encode_mesh_stl(mesh),
        encode_mesh_glb(mesh, "a.glb").value(), std::string(), std::string("ply\n"),
        std::string("ply\ncomment Museum number: X\nend_header\n"), std::string("glTF")}) {
    EXPECT_TRUE(file_label_in(bytes).empty());
  }
}

TEST(MeshLabel, WhatPeopleTypeBreaksNoFile) {
  const ScratchFolder folder;
  const Mesh mesh = tetrahedron();
  const std::string longest(3U << 20U, 'x');
  for (const std::string& text :
       {std::string("solid"), std::string("a\nend_header\nelement vertex 0\r\0b", 32),
        std::string("end_header"), std::string("v 1 2 3\nf 1 1 1 \\"),
        std::string("\xff\xc3 \"} COLOR=rgba 𒀭 \x1b[2J"), longest, "ä" + std::string(1000, ' ') + longest}) {
    const FileLabel label{.name = text, .rights = text, .simulated = false, .words = {{"Rights", text}}};
    for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb"}) {
      ASSERT_TRUE(write_mesh(folder / name, mesh, label)) << name;
      const auto back = read_mesh(folder / name);
      ASSERT_TRUE(back) << line_of(back);
      EXPECT_EQ(back->positions.size(), 4U) << name;
      EXPECT_EQ(back->faces.size(), 4U) << name;
    }
    const std::string stl = encode_mesh_stl(mesh, label).substr(0, 80);
    EXPECT_FALSE(stl.starts_with("solid"));
    EXPECT_EQ(stl.find('='), std::string::npos);
    EXPECT_TRUE(std::ranges::all_of(stl, [](char c) { return c >= ' ' && c < '\x7f'; })) << stl;
    const std::string ply = encode_mesh_ply(mesh, label);
    const std::string head = ply.substr(0, ply.find("end_header\n"));
    EXPECT_THAT(head, HasSubstr("element face 4"));
    for (std::size_t at = 0; at < head.size();) {
      const std::size_t end = head.find('\n', at);
      EXPECT_LE(end - at, kMaxLabelLineBytes);
      EXPECT_TRUE(as_utf8(head.substr(at, end - at)) == head.substr(at, end - at)) << "a character cut apart";
      at = end + 1;
    }
  }
}

}  // namespace
}  // namespace dubsar
