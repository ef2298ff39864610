// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// GLB by KHR_draco_mesh_compression: what comes back of what was written, and what is refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/random.h"
#include "formats/draco_mesh.h"
#include "formats/file_label_reader.h"
#include "formats/glb_container.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "tests/formats/closed_surface.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using testing::line_of;
using testing::ScratchFolder;

/// A ring of clay, 80 mm wide, with noise, normals and colours.
Mesh ring(std::uint32_t around = 120, std::uint32_t across = 60) {
  constexpr double kTurn = 2 * std::numbers::pi;
  Mesh mesh;
  Random random(11);
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = kTurn * i / around;
      const double b = kTurn * j / across;
      const double r = 10 + 0.01 * random.normal();
      mesh.positions.emplace_back(Eigen::Vector3d((30 + r * std::cos(b)) * std::cos(a),
                                                  (30 + r * std::cos(b)) * std::sin(a), r * std::sin(b))
                                      .cast<float>());
      mesh.colours.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), 200});
      const auto at = [&](std::uint32_t di, std::uint32_t dj) {
        return (i + di) % around * across + (j + dj) % across;
      };
      mesh.faces.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.faces.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

/// Which vertex of `mesh` lies less than a step from each of `back`; the count of vertices where none does.
std::vector<std::uint32_t> vertices_of(const Mesh& back, const Mesh& mesh, double step) {
  std::vector<std::uint32_t> by_x(mesh.positions.size());
  std::iota(by_x.begin(), by_x.end(), 0U);
  std::ranges::sort(by_x, {}, [&](std::uint32_t v) { return mesh.positions[v].x(); });
  std::vector<std::uint32_t> found;
  for (const Eigen::Vector3f& p : back.positions) {
    const auto is_near = [&](std::uint32_t v) {
      return (mesh.positions[v] - p).cast<double>().cwiseAbs().maxCoeff() < step;
    };
    auto at = std::ranges::lower_bound(by_x, p.x() - static_cast<float>(2 * step), {},
                                       [&](std::uint32_t v) { return mesh.positions[v].x(); });
    at = std::find_if(at, by_x.end(), is_near);
    found.push_back(at == by_x.end() ? static_cast<std::uint32_t>(mesh.positions.size()) : *at);
  }
  return found;
}

/// The faces by the numbers that their corners have in the other mesh, each from its least corner on.
std::vector<std::array<std::uint32_t, 3>> faces_of(const Mesh& mesh,
                                                   const std::vector<std::uint32_t>& numbers) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (const auto& face : mesh.faces) {
    std::array<std::uint32_t, 3> corners{numbers[face[0]], numbers[face[1]], numbers[face[2]]};
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    faces.push_back(corners);
  }
  std::ranges::sort(faces);
  return faces;
}

void expect_same(const Mesh& back, const Mesh& mesh, double step) {
  std::vector<std::uint32_t> own(mesh.positions.size());
  std::iota(own.begin(), own.end(), 0U);
  const std::vector<std::uint32_t> numbers = vertices_of(back, mesh, step);
  for (std::size_t v = 0; v < numbers.size(); ++v) {
    ASSERT_LT(numbers[v], mesh.positions.size()) << "nothing lies within " << step << " mm of vertex " << v;
    for (const float component : back.positions[v]) {
      EXPECT_EQ(component, std::round(component / step) * step) << "is no whole number of steps";
    }
  }
  EXPECT_TRUE(faces_of(back, numbers) == faces_of(mesh, own));
}

TEST(MeshDraco, KeepsEachFaceAndRoundsLessThanItSays) {
  const Mesh mesh = ring();
  const double step = draco_step_mm(mesh);
  EXPECT_EQ(step, 0x1p-16) << "of what is smaller than 128 mm";
  const std::string packed = encode_mesh_draco_glb(mesh, "t").value();
  EXPECT_LT(packed.size(), encode_mesh_glb(mesh, "t").value().size() / 4);
  const auto back = read_mesh_bytes(packed, "a.glb");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->positions.size(), mesh.positions.size());
  expect_same(*back, mesh, step);
  EXPECT_TRUE(testing::is_closed_and_oriented(*back));
  ASSERT_EQ(back->colours.size(), back->positions.size());
  const std::vector<std::uint32_t> numbers = vertices_of(*back, mesh, step);
  for (std::size_t v = 0; v < back->positions.size(); ++v) {
    EXPECT_EQ(back->colours[v], mesh.colours[numbers[v]]);
  }
}

TEST(MeshDraco, TheSameAgainGivesTheSamePlaces) {
  const Mesh first = read_mesh_bytes(encode_mesh_draco_glb(ring(), "t").value(), "a.glb").value();
  const Mesh second = read_mesh_bytes(encode_mesh_draco_glb(first, "t").value(), "a.glb").value();
  expect_same(second, first, 0x1p-30);
}

TEST(MeshDraco, StepsGrowOnlyWhereFloatsAreNoFinerThemselves) {
  Mesh mesh = ring();
  for (Eigen::Vector3f& p : mesh.positions) {
    p.x() += 200;  // reaches 240 mm
  }
  EXPECT_EQ(draco_step_mm(mesh), 0x1p-15);
  const auto back = read_mesh_bytes(encode_mesh_draco_glb(mesh, "t").value(), "a.glb");
  ASSERT_TRUE(back) << line_of(back);
  expect_same(*back, mesh, 0x1p-15);
}

TEST(MeshDraco, NormalsTurnByNoMoreThanItSays) {
  Mesh mesh = ring();
  Random random(3);
  for (Eigen::Vector3f& n : mesh.normals) {
    n = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized().cast<float>();
  }
  const DracoStream packed = encode_draco(mesh, {.normals = mesh.normals, .colours = {}}, "t").value();
  const auto back = decode_draco(
      packed.bytes, {.vertices = packed.vertices,
                     .faces = packed.faces,
                     .attributes = {kDracoPosition, static_cast<std::uint32_t>(*packed.normal)}});
  ASSERT_TRUE(back) << back.error();
  const auto at = [](const DracoNumbers& numbers, std::size_t v) {
    Eigen::Vector3f value;
    std::memcpy(value.data(), numbers.bytes.data() + 12 * v, 12);
    return value;
  };
  Mesh places;
  for (std::size_t v = 0; v < packed.vertices; ++v) {
    places.positions.push_back(at(back->numbers[0], v));
  }
  const std::vector<std::uint32_t> numbers = vertices_of(places, mesh, 0x1p-16);
  double worst_deg = 0;
  for (std::size_t v = 0; v < packed.vertices; ++v) {
    const Eigen::Vector3d a = mesh.normals[numbers.at(v)].cast<double>();
    const Eigen::Vector3d b = at(back->numbers[1], v).cast<double>();
    EXPECT_NEAR(b.norm(), 1, 1e-5);
    worst_deg = std::max(worst_deg, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
  }
  EXPECT_LT(worst_deg, kDracoNormalError_deg);
  EXPECT_GT(worst_deg, kDracoNormalError_deg / 4) << "what is said is not far from what is";
}

TEST(MeshDraco, SaysWhatReadersMustKnow) {
  FileLabel label;
  label.name = "BM 12345";
  label.rights = "CC0";
  label.words = {{"Museum number", "BM 12345"}};
  const std::string glb = encode_mesh_draco_glb(ring(), "t", label).value();
  const auto json = nlohmann::json::parse(split_glb(glb, "t").value().json);
  const nlohmann::json extension = {"KHR_draco_mesh_compression"};
  EXPECT_EQ(json["extensionsRequired"], extension);
  EXPECT_EQ(json["extensionsUsed"], extension);
  EXPECT_EQ(json["asset"]["copyright"], "CC0");
  EXPECT_EQ(json["nodes"][0]["scale"], nlohmann::json({0.001, 0.001, 0.001})) << "metres";
  for (const auto& accessor : json["accessors"]) {
    EXPECT_FALSE(accessor.contains("bufferView")) << "there is no other copy";
  }
  const Mesh back = read_mesh_bytes(glb, "a.glb").value();
  Eigen::Vector3f low = back.positions[0];
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : back.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(json["accessors"][0]["min"][static_cast<std::size_t>(k)].get<float>(), low[k]);
    EXPECT_EQ(json["accessors"][0]["max"][static_cast<std::size_t>(k)].get<float>(), high[k]);
  }
  EXPECT_EQ(label_lines(file_label_in(glb), ""), label_lines(label, ""));
}

TEST(MeshDraco, FaultsOfTheMeshComeBackAsTheyAre) {
  Mesh mesh = ring(12, 8);
  mesh.normals.clear();
  mesh.colours.clear();
  const std::size_t faces = mesh.faces.size();
  mesh.positions.emplace_back(0, 0, 90);
  mesh.positions.emplace_back(1, 2, 3);           // no face has it
  mesh.faces.push_back({0, 1, 96});               // a third face on an edge
  mesh.faces.push_back({5, 5, 6});                // no face
  std::swap(mesh.faces[7][0], mesh.faces[7][1]);  // turned over
  mesh.faces.erase(mesh.faces.begin() + 20);      // a hole
  mesh.positions.emplace_back(50, 60, 70);
  mesh.positions.emplace_back(51, 60, 70);
  mesh.faces.push_back({40, 98, 99});  // pinched: one vertex of two fans
  const auto back = read_mesh_bytes(encode_mesh_draco_glb(mesh, "t").value(), "a.glb");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->positions.size(), 99U);
  EXPECT_EQ(back->faces.size(), faces + 1);
  mesh.faces.erase(mesh.faces.end() - 2);  // that is no face
  expect_same(*back, mesh, 0x1p-16);
}

TEST(MeshDraco, IsWrittenByItsName) {
  const ScratchFolder folder;
  const Mesh mesh = ring();
  for (const char* name : {"a.draco.glb", "A.Draco.GLB"}) {
    ASSERT_TRUE(check_mesh_name(folder / name));
    const Status written = write_mesh(folder / name, mesh);
    ASSERT_TRUE(written) << written.error().line();
    EXPECT_LT(std::filesystem::file_size(folder / name), std::size_t{100000});
    EXPECT_EQ(read_mesh(folder / name).value().faces.size(), mesh.faces.size());
  }
  JobContext job;
  job.cancel();
  const Status stopped = write_mesh(folder / "b.draco.glb", mesh, {}, &job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(folder.file_count(), 2U);
  Mesh nothing = mesh;
  nothing.faces = {{1, 1, 2}};
  const Status refused = write_mesh(folder / "b.draco.glb", nothing);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(),
              HasSubstr("the mesh has no face that Draco compresses; write .ply instead"));
}

/// The ring's file with its JSON or its Draco data changed.
class MeshDracoHostile : public ::testing::Test {
 protected:
  [[nodiscard]] std::string line(const std::string& json, const std::string& binary) const {
    return line_of(read_mesh_bytes(join_glb(json, binary), "a.glb"));
  }
  [[nodiscard]] std::string with(const std::string& from, const std::string& to) const {
    std::string json = json_;
    const std::size_t at = json.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    json.replace(at, from.size(), to);
    return line(json, binary_);
  }
  [[nodiscard]] std::string with_byte(std::size_t at, char byte) const {
    std::string binary = binary_;
    binary[at] = byte;
    return line(json_, binary);
  }

  const std::string glb_ = encode_mesh_draco_glb(ring(), "t").value();
  const std::string json_{split_glb(glb_, "t").value().json};
  const std::string binary_{split_glb(glb_, "t").value().binary};
  const std::string vertices_ = "\"count\": 7200";
};

constexpr const char* kPrimitive = "a.glb: meshes[0].primitives[0] ";

TEST_F(MeshDracoHostile, DamagedDataAreOneLine) {
  EXPECT_EQ(line(json_, binary_), "no error");
  const std::string damaged =
      std::string(kPrimitive) + "holds damaged Draco data; export the mesh again, uncompressed";
  EXPECT_EQ(with_byte(0, 'X'), damaged);
  EXPECT_EQ(with_byte(7, 0), damaged) << "a cloud of points";
  EXPECT_THAT(with_byte(6, 1), HasSubstr("holds Draco data of version 2.1, and only 2.2 is read"));
  EXPECT_THAT(with_byte(10, '\x80'), HasSubstr("holds Draco data with metadata, which are not read"));
  for (std::size_t size = 0; size < binary_.size(); size += 97) {
    std::string json = json_;
    const std::string length = "\"byteLength\": ";
    std::size_t digits = 0;
    for (std::size_t at = json.find(length); at != std::string::npos; at = json.find(length, at + 1)) {
      digits = json.find_first_not_of("0123456789", at + length.size()) - at - length.size();
      json.replace(at + length.size(), digits, std::to_string(size));
    }
    EXPECT_EQ(line(json, binary_.substr(0, size)), damaged) << size;
  }
}

TEST_F(MeshDracoHostile, CountsAreHeldAgainstEachOther) {
  const std::string other = "holds other numbers of faces or vertices than its accessors say";
  EXPECT_THAT(with("\"count\": 43200", "\"count\": 43203"), HasSubstr(other));
  std::string json = json_;
  for (std::size_t at = json.find(vertices_); at != std::string::npos; at = json.find(vertices_)) {
    json.replace(at, vertices_.size(), "\"count\": 7300");
  }
  EXPECT_THAT(line(json, binary_), HasSubstr(other));
  EXPECT_THAT(with("\"count\": 43200", "\"count\": 43201"), HasSubstr("which are no whole triangles"));
  EXPECT_THAT(with("\"count\": 43200", "\"count\": 4320000"), HasSubstr("a.glb: meshes[0].primitives[0] "));
  EXPECT_THAT(with(vertices_, "\"count\": 0"), HasSubstr("accessors[0].count is 0, out of range"));
  EXPECT_THAT(with("\"POSITION\": 0,\n      \"NORMAL\"", "\"POSITION\": 2,\n      \"NORMAL\""),
              HasSubstr("accessors[2].type is not VEC3"));
}

TEST_F(MeshDracoHostile, WhatTheExtensionNamesMustBeThere) {
  const std::size_t extension = json_.find("\"extensions\"");
  ASSERT_NE(extension, std::string::npos);
  const auto within = [&](const std::string& from, const std::string& to) {
    std::string json = json_;
    const std::size_t at = json.find(from, extension);
    EXPECT_NE(at, std::string::npos) << from;
    json.replace(at, from.size(), to);
    return line(json, binary_);
  };
  EXPECT_THAT(within("\"POSITION\": 0", "\"POSITION\": 7"), HasSubstr("lacks in its Draco data attribute 7"));
  EXPECT_THAT(within("\"POSITION\": 0", "\"POSITION\": 2"),
              HasSubstr("holds Draco data of another kind than its accessors say"));
  EXPECT_THAT(within("\"bufferView\": 0", "\"bufferView\": 3"), HasSubstr("bufferViews[3] is missing"));
  EXPECT_THAT(within("\"COLOR_0\"", "\"COLOUR\""), HasSubstr("COLOR_0 is missing"));
}

TEST(MeshDracoClaims, AreBoundByTheBytes) {
  const Mesh mesh = ring(8, 6);
  const DracoStream packed = encode_draco(mesh, {}, "t").value();
  DracoClaim claim{.vertices = packed.vertices, .faces = packed.faces, .attributes = {kDracoPosition}};
  ASSERT_TRUE(decode_draco(packed.bytes, claim));
  claim.faces = max_packed_items(packed.bytes.size()) + 1;
  EXPECT_THAT(decode_draco(packed.bytes, claim).error(),
              HasSubstr("claims more faces or vertices than its " + std::to_string(packed.bytes.size())));
  claim.faces = packed.faces;
  claim.vertices = max_packed_items(packed.bytes.size()) + 1;
  EXPECT_FALSE(decode_draco(packed.bytes, claim));
}

/// Even squares of 1 mm in a plane, each cut in two.
Mesh even_plane(std::uint32_t rows, std::uint32_t cols) {
  Mesh plane;
  for (std::uint32_t v = 0; v < rows * cols; ++v) {
    plane.positions.emplace_back(static_cast<float>(v / cols), static_cast<float>(v % cols), 0.0F);
    if (v / cols + 1 < rows && v % cols + 1 < cols) {
      plane.faces.push_back({v, v + cols, v + cols + 1});
      plane.faces.push_back({v, v + cols + 1, v + 1});
    }
  }
  return plane;
}

TEST(MeshDracoClaims, APlaneIsBelieved) {
  const Mesh plane = even_plane(300, 300);
  const std::string packed = encode_mesh_draco_glb(plane, "t").value();
  EXPECT_LT(packed.size(), plane.faces.size() / 4);
  const auto back = read_mesh_bytes(packed, "a.glb");
  ASSERT_TRUE(back) << line_of(back);
  EXPECT_EQ(back->faces.size(), plane.faces.size());
}

TEST(MeshDracoClaims, WhatWouldNotBeBelievedIsNotWritten) {
  const auto packed = encode_mesh_draco_glb(even_plane(10, 20000), "t");
  ASSERT_FALSE(packed);
  EXPECT_EQ(packed.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(packed.error().line(), HasSubstr("would not be believed"));
}

}  // namespace
}  // namespace dubsar
