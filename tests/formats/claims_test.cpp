// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Small files that claim to be huge: a reader takes memory for what is there, not for what is claimed.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <string>

#include "formats/byte_order.h"
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
