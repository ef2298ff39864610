// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/region_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "archive/report_pictures.h"

namespace dubsar {
namespace {

/// Two plates of 40 x 30 mm, 20 mm apart, in triangles of half a millimetre as a stitched mesh has them: the
/// obverse and the reverse of a tablet without edges.
Mesh plates() {
  constexpr int kAcross = 81;
  constexpr int kDown = 61;
  Mesh mesh;
  for (const float z : {10.0F, -10.0F}) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (int r = 0; r < kDown; ++r) {
      for (int c = 0; c < kAcross; ++c) {
        mesh.positions.emplace_back(0.5F * static_cast<float>(c) - 20.0F,
                                    0.5F * static_cast<float>(r) - 15.0F, z);
      }
    }
    for (std::uint32_t r = 0; r + 1 < kDown; ++r) {
      for (std::uint32_t c = 0; c + 1 < kAcross; ++c) {
        const std::uint32_t a = base + r * kAcross + c;
        const std::uint32_t b = a + 1, d = a + kAcross, e = d + 1;
        mesh.faces.push_back(z > 0 ? std::array{a, b, e} : std::array{a, e, b});
        mesh.faces.push_back(z > 0 ? std::array{a, e, d} : std::array{a, d, e});
      }
    }
  }
  return mesh;
}

bool is_mark(Rgb8 colour) {
  return colour[0] > 180 && colour[1] < 80;
}
bool is_ring(Rgb8 colour) {
  return colour[2] > 150 && colour[0] < 90;
}

TEST(RegionPicture, ShowsThePlaceInItsMiddleWithMarksAndARing) {
  const Mesh mesh = plates();
  ColouredPoints marks;
  marks.positions_mm = {{10, 5, 10}, {-20, 5, 10}};
  RedRegion region;
  region.center_mm = {10, 5, 10};
  region.area_mm2 = 0.5;
  const auto image = region_picture(mesh, marks, region, {0, 0, 1}, {}, JobContext());
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->width, image->height);
  EXPECT_NEAR(image->mm_per_px * image->width, 6, 1e-9) << "small places get room round them";
  EXPECT_TRUE(is_mark(image->rgb(image->width / 2, image->height / 2)));
  int marked = 0;
  int ring = 0;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      marked += is_mark(image->rgb(x, y)) ? 1 : 0;
      ring += is_ring(image->rgb(x, y)) ? 1 : 0;
    }
  }
  EXPECT_GT(ring, 60);
  EXPECT_LT(marked, 200) << "the other mark is far away";
  const auto again = region_picture(mesh, marks, region, {0, 0, 1}, {}, JobContext());
  EXPECT_EQ(image->bytes, again->bytes);
}

TEST(RegionPicture, WhatLiesFarBeforeThePlaceDoesNotHideIt) {
  const Mesh mesh = plates();
  RedRegion region;
  region.center_mm = {0, 0, -10};  // looked at through the obverse, from above
  region.area_mm2 = 0.5;
  ColouredPoints marks;
  marks.positions_mm = {{0, 0, -10}};
  const auto image = region_picture(mesh, marks, region, {0, 0, 1}, {}, JobContext());
  ASSERT_TRUE(image);
  EXPECT_TRUE(is_mark(image->rgb(image->width / 2, image->height / 2)));
}

TEST(RegionPicture, NothingMeshedNearIsAnEmptyPictureWithTheRing) {
  RedRegion region;
  region.center_mm = {500, 0, 0};
  const auto image = region_picture(plates(), {}, region, {0, 0, 1}, {}, JobContext());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->rgb(2, 2), kPaper);
}

TEST(RegionPicture, TheRingOfALargePlaceFitsIn) {
  RedRegion region;
  region.center_mm = {0, 0, 10};
  region.area_mm2 = 2000;
  const auto image = region_picture(plates(), {}, region, {0, 0, 1}, {}, JobContext());
  ASSERT_TRUE(image);
  EXPECT_GT(image->mm_per_px * image->width, 1.3 * 2 * std::sqrt(2000 / 3.14159265));
}

TEST(RegionPicture, LooksFromWhereTheClayLooks) {
  const Mesh mesh = plates();
  RedRegion region;
  region.center_mm = {0, 0, -10};
  region.normal = {1, 0, 0};  // as across a crack
  EXPECT_LT((outlook(mesh, region) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-6);
  region.center_mm = {0, 0, 300};
  EXPECT_EQ(outlook(mesh, region), region.normal) << "no clay there";
  region.center_mm = {0, 0, 9};
  region.normal = {0, 0, -1};  // a side that nobody has seen, before the one opposite
  EXPECT_EQ(outlook(mesh, region), region.normal);
  EXPECT_EQ(face_towards({0, 0, -1}, {}), Face::kReverse);
  EXPECT_EQ(face_towards({-1, 0, 0.2}, {}), Face::kLeft);
}

TEST(RegionPicture, HalvedKeepsTheScale) {
  Image image = filled_image(5, 4, {10, 20, 30});
  image.mm_per_px = 0.1;
  fill_rectangle(image, 0, 0, 1, 2, {20, 20, 30});
  const Image half = halved(image);
  EXPECT_EQ(half.width, 2);
  EXPECT_EQ(half.height, 2);
  EXPECT_EQ(half.rgb(0, 0), (Rgb8{15, 20, 30}));
  EXPECT_EQ(half.rgb(1, 1), (Rgb8{10, 20, 30}));
  EXPECT_DOUBLE_EQ(half.mm_per_px, 0.2);
}

TEST(RegionPicture, BiggestPlacesGetPicturesRedOnesFirst) {
  RedMap map;
  for (int k = 0; k < 4; ++k) {
    RedRegion region;
    region.area_mm2 = k;
    region.state = k == 1 ? RegionState::kRed : RegionState::kExcused;
    map.regions.push_back(region);
  }
  EXPECT_EQ(regions_by_weight(map), (std::vector<std::size_t>{1, 3, 2})) << "the stray is left out";
}

}  // namespace
}  // namespace dubsar
