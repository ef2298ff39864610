// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Small files that claim to be huge: a reader takes memory for what is there, not for what is claimed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include <string>

#include "formats/byte_order.h"
#include "formats/draco_mesh.h"
#include "formats/glb_container.h"
#include "formats/gray_file.h"
#include "formats/gray_jpeg.h"
#include "formats/grid_file.h"
#include "formats/grid_reader.h"
#include "formats/json_node.h"
#include "formats/mesh_io.h"
#include "tests/formats/largest_request.h"

namespace dubsar {
namespace {

/// What any reader may take for a file of a few hundred bytes: its own buffers.
constexpr std::size_t kEnoughBytes = std::size_t{4} << 20U;

/// Reads and gives back what the reader said, having seen that it asked for no large block of memory.
template <class Reader>
std::string refusal(const char* name, const Reader& reader) {
  test::forget_largest_request();
  const auto result = reader();
  EXPECT_LE(test::largest_request_bytes(), kEnoughBytes) << name;
  EXPECT_FALSE(result.has_value()) << name;
  if (result.has_value()) {
    return {};
  }
  EXPECT_EQ(result.error().kind, ErrorKind::kBadInput) << name << ": " << result.error().line();
  return result.error().line();
}

constexpr const char* kScanHead =
    "ply\nformat binary_little_endian 1.0\nobj_info num_cols 1000000\nobj_info num_rows 1000000\n";

TEST(Claims, RangeGridsOfATrillionSamples) {
  const auto scan = [](const std::string& name, const std::string& bytes) {
    EXPECT_NE(refusal(name.c_str(), [&] { return read_scan_bytes(bytes, name, {}); }), "");
  };
  scan("vertices.ply",
       std::string(kScanHead) +
           "element vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\n"
           "element range_grid 1000000000000\nproperty list uchar int vertex_indices\nend_header\n" +
           std::string(64, '\0'));
  scan("cells.ply",
       std::string(kScanHead) +
           "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
           "element range_grid 1000000000000\nproperty list uchar int vertex_indices\nend_header\n" +
           std::string(64, '\0'));
  scan("list.ply", std::string(kScanHead) +
                       "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                       "element range_grid 1\nproperty list uint int vertex_indices\nend_header\n" +
                       std::string(12, '\0') + "\xff\xff\xff\xff");
  const std::string frame = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  scan("wide.ptx", "1000000\n1000000\n" + frame + "1 2 3 0.5\n");
  scan("wider.ptx", "1000000000000\n1\n" + frame + "1 2 3 0.5\n");
}

TEST(Claims, OwnGridsOfATrillionSamples) {
  RangeGrid grid;
  grid.allocate(2, 2);
  grid.valid[0] = 1;
  grid.spacing_mm = 0.1;
  const std::vector<std::byte> good = encode_grid(grid);
  std::string bytes(reinterpret_cast<const char*>(good.data()), good.size());
  std::string sides;
  append(sides, std::uint32_t{1000000});
  append(sides, std::uint32_t{1000000});
  bytes.replace(24, sides.size(), sides);
  for (const std::uint64_t samples : {std::uint64_t{1}, std::uint64_t{1000000000000}}) {
    std::string count;
    append(count, samples);
    bytes.replace(36, count.size(), count);
    bytes.resize(bytes.size() - 8);
    append(bytes, std::uint64_t{XXH64(bytes.data(), bytes.size(), 0)});
    EXPECT_NE(refusal("huge.grid", [&] { return decode_grid(std::as_bytes(std::span(bytes)), "huge.grid"); }),
              "");
  }
}

TEST(Claims, MeshesOfATrillionVertices) {
  const auto mesh = [](const std::string& name, const std::string& bytes) {
    EXPECT_NE(refusal(name.c_str(), [&] { return read_mesh_bytes(bytes, name); }), "");
  };
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  mesh("vertices.ply", head + "element vertex 1000000000000\n" + xyz +
                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                           std::string(64, '\0'));
  mesh("faces.ply", head + "element vertex 1\n" + xyz +
                        "element face 1000000000000\nproperty list uchar int vertex_indices\nend_header\n" +
                        std::string(64, '\0'));
  // So many that their 13 bytes each are 10 bytes beyond what 64 bits count.
  mesh("wrapped.ply",
       head + "element vertex 1\n" + xyz +
           "element face 1418980313362273202\nproperty list uchar int vertex_indices\nend_header\n" +
           std::string(64, '\0'));
  std::string stl(80, ' ');
  append(stl, std::uint32_t{0xffffffffU});
  mesh("many.stl", stl + std::string(100, '\0'));
  const auto glb = [](const std::string& json) {
    std::string padded = json;
    padded.resize((json.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    append(out, std::uint32_t{2});
    append(out, static_cast<std::uint32_t>(12 + 8 + padded.size() + 8 + 16));
    append(out, static_cast<std::uint32_t>(padded.size()));
    out += "JSON" + padded;
    append(out, std::uint32_t{16});
    return out + std::string("BIN\0", 4) + std::string(16, '\0');
  };
  const std::string start =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)";
  mesh("accessor.glb",
       glb(start + R"("buffers":[{"byteLength":16}],"bufferViews":[{"buffer":0,"byteLength":16}],)"
                   R"("accessors":[{"bufferView":0,"componentType":5126,"count":1000000000000,)"
                   R"("type":"VEC3"}]})"));
  mesh("buffer.glb", glb(start + R"("buffers":[{"byteLength":1000000000000}],)"
                                 R"("bufferViews":[{"buffer":0,"byteLength":1000000000000}],)"
                                 R"("accessors":[{"bufferView":0,"componentType":5126,"count":80000000000,)"
                                 R"("type":"VEC3"}]})"));
  mesh("nothing.glb",
       glb(start + R"("accessors":[{"componentType":5126,"count":1000000000000,"type":"VEC3"}]})"));
}

/// Each visit of the node would take the memory of all of its children, which are the node again.
TEST(Claims, ANodeThatIsItsOwnChildOverAndOver) {
  constexpr int kTimes = 2000;
  std::string nodes = R"({"children":[0)";
  for (int k = 1; k < kTimes; ++k) {
    nodes += ",0";
  }
  nodes += "]}";
  for (int k = 1; k < kTimes; ++k) {
    nodes += ",{}";
  }
  const std::string bytes =
      join_glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes + "]}",
               std::string(16, '\0'));
  EXPECT_NE(refusal("children.glb", [&] { return read_mesh_bytes(bytes, "children.glb"); })
                .find("is the child of more than one node"),
            std::string::npos);
}

/// What a Draco stream claims in its own head, and what its tables do, where the accessors agree.
TEST(Claims, CompressedMeshesOfABillionFaces) {
  const auto glb = [](const std::string& draco, std::uint64_t vertices, std::uint64_t faces) {
    const std::string length = std::to_string(draco.size());
    return join_glb(
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
        R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}],)"
        R"("buffers":[{"byteLength":)" +
            length + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + length +
            R"(}],"accessors":[{"componentType":5126,"count":)" + std::to_string(vertices) +
            R"(,"type":"VEC3"},{"componentType":5125,"count":)" + std::to_string(3 * faces) +
            R"(,"type":"SCALAR"}]})",
        draco);
  };
  const std::string head("DRACO\x02\x02\x01", 8);
  const std::string edgebreaker = head + std::string("\x01\0\0\0", 4);
  const std::string sequential = head + std::string("\0\0\0", 3);
  const std::string billion = "\x80\x94\xeb\xdc\x03";
  const std::string rest(64, '\x7f');
  const auto mesh = [](const std::string& name, const std::string& bytes) {
    EXPECT_NE(refusal(name.c_str(), [&] { return read_mesh_bytes(bytes, name); }), "");
  };
  mesh("accessors.glb", glb(edgebreaker + billion + billion + rest, 1000000000, 1000000000));
  mesh("edgebreaker.glb", glb(edgebreaker + billion + billion + rest, 1000, 1000));
  mesh("sequential.glb", glb(sequential + billion + billion + rest, 1000, 1000));
  mesh("seams.glb", glb(edgebreaker + "\xe8\x07\xe8\x07\xff" + rest, 1000, 1000));
  // 20 faces whose indices are symbols of an alphabet of a billion.
  mesh("alphabet.glb", glb(sequential + std::string("\x14\x0a\0\x01\x12", 5) + billion + rest, 10, 20));
  // A vertex of 255 numbers.
  Mesh small;
  small.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  small.faces = {{0, 1, 2}};
  std::string draco = encode_draco(small, {}, "t").value().bytes;
  const std::size_t attribute = draco.find(std::string("\x01\0\x09\x03\0\0", 6));
  ASSERT_NE(attribute, std::string::npos);
  draco[attribute + 3] = '\xff';
  EXPECT_THAT(refusal("wide.glb", [&] { return read_mesh_bytes(glb(draco, 3, 1), "wide.glb"); }),
              ::testing::HasSubstr("holds more attributes than are read"));
}

TEST(Claims, PicturesOfATrillionPixels) {
  EXPECT_NE(refusal("wide.pgm", [] { return parse_gray("P5\n1000000 1000000\n255\nabc", "wide.pgm"); }), "");
  // A JPEG's head alone: 65500 x 65500, grey.
  const std::string head(
      "\xff\xd8\xff\xc0\x00\x0b\x08\xff\xdc\xff\xdc\x01\x01\x11\x00\xff\xda\x00\x08\x01\x01\x00\x00\x3f\x00"
      "\x12",
      26);
  EXPECT_NE(refusal("wide.jpg", [&] { return parse_gray_jpeg(head, "wide.jpg"); }), "");
}

TEST(Claims, TextThatIsDeeperOrLongerThanItMayBe) {
  EXPECT_NE(refusal("deep.json", [] { return JsonDocument::parse(std::string(100000, '['), "deep.json"); }),
            "");
}

}  // namespace
}  // namespace dubsar
