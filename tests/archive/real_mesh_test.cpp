// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <filesystem>

#include "archive/six_views.h"
#include "formats/mesh_io.h"
#include "tests/support/real_data.h"

namespace dubsar {
namespace {

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
  const auto file = test::real_data() / "stanford_bunny/reconstruction/bun_zipper.ply";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "no " << file.string() << ": set DUBSAR_DATA to the folder of real scans";
  }
  const Result<Mesh> read = read_mesh(file, {.mm_per_unit = 1000.0});
  ASSERT_TRUE(read) << read.error().line();
  const Mesh& bunny = *read;
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
