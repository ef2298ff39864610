// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bytes_left_over.h"

#include <algorithm>

#include "formats/grid_reader.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "tests/formats/format_support.h"
#include "tests/formats/tetrahedron.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::line_of;
using testing::tetrahedron;

/// What reading a mesh says on standard error.
std::string said_of(const std::string& bytes, const std::string& name) {
  ::testing::internal::CaptureStderr();
  const auto mesh = read_mesh_bytes(bytes, name);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(mesh) << line_of(mesh);
  return said;
}

const std::string kText =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(BytesLeftOver, BlanksAreNone) {
  EXPECT_EQ(bytes_left_over(""), "");
  EXPECT_EQ(bytes_left_over(" \r\n\n\t"), "");
  EXPECT_THAT(bytes_left_over("\n3 0 1 2\n"), HasSubstr("7 bytes follow"));
  EXPECT_THAT(bytes_left_over(std::string_view("\0", 1)), HasSubstr("1 bytes follow"));
}

TEST(BytesLeftOver, OfAMeshTheyAreToldOnOneLine) {
  const std::string binary = encode_mesh_ply(tetrahedron());
  EXPECT_EQ(said_of(binary, "a.ply"), "");
  EXPECT_EQ(said_of(binary + "\n", "a.ply"), "") << "some end so";
  const std::string said = said_of(binary + binary.substr(binary.size() - 13), "a.ply");
  EXPECT_THAT(said,
              HasSubstr("a.ply: 13 bytes follow what the header tells of and are passed over; export it "
                        "again if something is missing"));
  EXPECT_EQ(std::ranges::count(said, '\n'), 1);

  EXPECT_EQ(said_of(kText + "\n\n", "a.ply"), "");
  EXPECT_THAT(said_of(kText + "3 2 1 0\n", "a.ply"), HasSubstr("a.ply: 7 bytes follow"));
  EXPECT_THAT(said_of(kText + "junk junk", "a.ply"), HasSubstr("a.ply: 9 bytes follow"));

  const std::string stl = encode_mesh_stl(tetrahedron());
  EXPECT_EQ(said_of(stl, "a.stl"), "");
  EXPECT_THAT(said_of(stl + stl.substr(stl.size() - 50), "a.stl"), HasSubstr("a.stl: 50 bytes follow"));

  const std::string glb = encode_mesh_glb(tetrahedron(), "t").value();
  EXPECT_EQ(said_of(glb, "a.glb"), "");
  EXPECT_THAT(said_of(glb + "a signature, say", "a.glb"), HasSubstr("a.glb: 16 bytes follow"));
  EXPECT_THAT(said_of(glb + std::string(16, '\0'), "a.glb"), HasSubstr("a.glb: 16 bytes follow"));
  std::string too_small = glb;  // as a program wrote it that counted the JSON alone
  too_small.replace(8, 4, std::string("\x0c\0\0\0", 4));
  EXPECT_EQ(said_of(too_small, "a.glb"), "");
}

TEST(BytesLeftOver, OfAScanTheyAreRemarked) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string body =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
      "0 0 0\n1 0 0.5\n0 1 0\n1 1 0\n";
  std::vector<std::string> told;
  const GridReadOptions options{.remark = [&](const std::string& scan, const std::string& remark) {
    told.push_back(scan + ": " + remark);
  }};
  for (const std::string& ordered :
       {std::string("obj_info num_cols 2\nobj_info num_rows 2\n"), std::string()}) {
    told.clear();
    ASSERT_TRUE(read_scan_bytes(head + ordered + body, "a.ply", options));
    EXPECT_THAT(told, ElementsAre());
    ASSERT_TRUE(read_scan_bytes(head + ordered + body + "2 2 0\n", "a.ply", options));
    EXPECT_THAT(told, ElementsAre(HasSubstr("a.ply: 5 bytes follow what the header tells of"))) << ordered;
  }
}

}  // namespace
}  // namespace dubsar
