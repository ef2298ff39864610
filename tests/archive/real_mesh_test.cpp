// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "archive/six_views.h"

namespace dubsar {
namespace {

/// Positions and triangles of a plain ASCII PLY; this module has no reader of its own.
Mesh ascii_ply(const std::filesystem::path& path, float mm_per_unit) {
  std::ifstream in(path);
  std::string line;
  std::size_t vertices = 0, faces = 0;
  while (std::getline(in, line) && line.rfind("end_header", 0) != 0) {
    if (line.rfind("element vertex ", 0) == 0) {
      vertices = std::stoul(line.substr(15));
    } else if (line.rfind("element face ", 0) == 0) {
      faces = std::stoul(line.substr(13));
    }
  }
  Mesh mesh;
  for (std::size_t i = 0; i < vertices && std::getline(in, line); ++i) {
    std::istringstream words(line);
    float x = 0, y = 0, z = 0;
    words >> x >> y >> z;
    mesh.positions.push_back(mm_per_unit * Eigen::Vector3f(x, y, z));
  }
  for (std::size_t i = 0; i < faces && std::getline(in, line); ++i) {
    std::istringstream words(line);
    unsigned corners = 0, a = 0, b = 0, c = 0;
    words >> corners >> a >> b >> c;
    mesh.faces.push_back({a, b, c});
  }
  return mesh;
}

int inside_pixels(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      count += image.rgb(x, y) == Rgb8{58, 54, 56} ? 1 : 0;
    }
  }
  return count;
}

// The published bunny has four holes in its base and a small one between its forelegs, which the sides see a
// little of; nothing is open above.
TEST(RealMesh, HolesInTheBaseOfTheBunnyShowTheInsideFromBelow) {
  const char* set = std::getenv("DUBSAR_DATA");
  const std::filesystem::path data = set != nullptr
                                         ? std::filesystem::path(set)
                                         : std::filesystem::path(DUBSAR_SOURCE_DIR) / "../shared/data";
  const auto file = data / "stanford_bunny/reconstruction/bun_zipper.ply";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "no " << file.string() << ": set DUBSAR_DATA to the folder of real scans";
  }
  const Mesh bunny = ascii_ply(file, 1000.0F);
  ASSERT_EQ(bunny.positions.size(), 35947U);
  const JobContext job;
  SixViewOptions options;
  options.render.longest_px = 400;
  const auto views = render_six_views(RenderScene(bunny), options, job);
  ASSERT_TRUE(views) << views.error().line();
  const int below = inside_pixels((*views)[Face::kBottom]);
  EXPECT_GT(below, 500);
  EXPECT_EQ(inside_pixels((*views)[Face::kTop]), 0);
  for (const Face face : {Face::kObverse, Face::kReverse, Face::kLeft, Face::kRight}) {
    EXPECT_LT(inside_pixels((*views)[face]), below / 10) << to_string(face);
  }
  // 155.7 × 154.3 × 120.7 mm.
  const Image& front = (*views)[Face::kObverse];
  EXPECT_NEAR(front.width * front.mm_per_px, 155.7, 13 * front.mm_per_px);
  EXPECT_NEAR(front.height * front.mm_per_px, 154.3, 13 * front.mm_per_px);
}

}  // namespace
}  // namespace dubsar
