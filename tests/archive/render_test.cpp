// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

Image drawn(const Mesh& mesh, Face face, RenderOptions options, const ColouredPoints* points = nullptr) {
  const RenderScene scene(mesh, points);
  const JobContext job;
  auto image = render(scene, face_camera(face), options, job);
  EXPECT_TRUE(image) << image.error().line();
  return image ? *image : Image{};
}

RenderOptions colours_at(double mm_per_px) {
  RenderOptions options;
  options.mm_per_px = mm_per_px;
  options.style = RenderStyle::kColours;
  return options;
}

int brightness(Rgb8 c) {
  return c[0] + c[1] + c[2];
}

TEST(Render, EachViewShowsItsFace) {
  const Mesh box = coloured_box(10, 8, 4);
  for (int f = 0; f < kFaceCount; ++f) {
    const Image image = drawn(box, static_cast<Face>(f), colours_at(0.05));
    // The lower left quarter of every view is free of marks.
    EXPECT_EQ(nearest_face_colour(image.rgb(image.width / 4, image.height * 3 / 4)), f)
        << to_string(static_cast<Face>(f));
  }
}

// Marks at (+x, +y) of the obverse and (+x, -y) of the reverse: both upper right when the tablet is turned
// over about its horizontal axis, upper left if a view were mirrored.
TEST(Render, NothingIsMirrored) {
  const Mesh box = coloured_box(10, 8, 4);
  for (const Face face : {Face::kObverse, Face::kReverse}) {
    const Image image = drawn(box, face, colours_at(0.05));
    EXPECT_LT(brightness(image.rgb(image.width * 3 / 4, image.height / 4)), 60) << to_string(face);
    EXPECT_GT(brightness(image.rgb(image.width / 4, image.height / 4)), 120) << to_string(face);
    EXPECT_GT(brightness(image.rgb(image.width * 3 / 4, image.height * 3 / 4)), 120) << to_string(face);
  }
}

TEST(Render, IsToScaleFarFromTheOriginToo) {
  for (const float away : {0.0F, 3000.0F}) {
    const Mesh box = coloured_box(10, 8, 4, away, -away, away);
    RenderOptions options = colours_at(0.04);
    options.background = {255, 255, 255};
    const Image image = drawn(box, Face::kObverse, options);
    EXPECT_DOUBLE_EQ(image.mm_per_px, 0.04);
    int first = image.width, last = -1;
    for (int x = 0; x < image.width; ++x) {
      if (image.rgb(x, image.height * 3 / 4) != Rgb8{255, 255, 255}) {
        first = std::min(first, x);
        last = x;
      }
    }
    EXPECT_NEAR(last - first + 1, 10 / 0.04, 1.0) << away;
  }
}

TEST(Render, TheLongestSideIsAsLongAsAskedFor) {
  RenderOptions options;
  options.longest_px = 300;
  options.margin_px = 5;
  const Image image = drawn(coloured_box(10, 8, 4), Face::kObverse, options);
  EXPECT_EQ(image.width, 310);
  EXPECT_EQ(image.height, 250);
}

TEST(Render, SameBytesForOneThreadAndTwo) {
  const Mesh mesh =
      height_sheet(120, 12.0F, [](float x, float y) { return std::sin(3 * x) * std::cos(2 * y); });
  ColouredPoints points;
  points.positions_mm = {{1, 1, 0.5F}, {1.1F, 1, 0.5F}, {-2, 3, 1}};
  RenderOptions options;
  options.longest_px = 240;
  std::vector<std::uint8_t> of[2];
  for (int threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    of[threads - 1] = drawn(mesh, Face::kObverse, options, &points).bytes;
  }
  EXPECT_EQ(of[0], of[1]);
}

// Light from the upper left: a pit's wall towards the lamp lies in the dark, the far wall in the light.
TEST(Render, LightRakesFromTheUpperLeft) {
  const Mesh pit = height_sheet(
      160, 8.0F, [](float x, float y) { return -std::max(0.0F, 1.0F - 0.7F * std::hypot(x, y)); });
  RenderOptions options;
  options.mm_per_px = 0.04;
  options.margin_px = 0;
  const Image image = drawn(pit, Face::kObverse, options);
  const int c = image.width / 2;
  const int off = static_cast<int>(0.5 / 0.04);
  const int near_lamp = brightness(image.rgb(c - off, c - off));
  const int far_side = brightness(image.rgb(c + off, c + off));
  const int flat = brightness(image.rgb(image.width / 8, image.height / 8));
  EXPECT_LT(near_lamp + 60, far_side);
  EXPECT_LT(near_lamp, flat);
}

TEST(Render, RedMapPaintsPointsRedAndNoVertices) {
  Mesh sheet = height_sheet(20, 10.0F, [](float, float) { return 0.0F; });
  sheet.flags.assign(sheet.positions.size(), 0);
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    sheet.flags[i] = sheet.positions[i].x() < -2   ? kVertexSparse
                     : sheet.positions[i].y() < -2 ? kVertexInterpolated
                                                   : 0;
  }
  ColouredPoints points;
  points.positions_mm = {{3, 3, 0}};
  points.radius_mm = 0.6F;
  RenderOptions options;
  options.mm_per_px = 0.1;
  options.margin_px = 0;
  options.style = RenderStyle::kRedMap;
  const Image image = drawn(sheet, Face::kObverse, options, &points);
  const auto is_reddish = [](Rgb8 c) { return c[0] > 100 && c[0] > 2 * c[1] && c[0] > 2 * c[2]; };
  EXPECT_FALSE(is_reddish(image.rgb(10, 50))) << "a sparse vertex may be clay that other scans have seen";
  EXPECT_EQ(image.rgb(10, 50), image.rgb(50, 50)) << "sound clay";
  EXPECT_NE(image.rgb(50, 90), image.rgb(50, 50)) << "interpolated vertices";
  EXPECT_EQ(image.rgb(80, 20), kRedOfSparse) << "points are painted flat";
}

TEST(Render, FallsBackToClayWithoutValues) {
  Mesh sheet = height_sheet(4, 4.0F, [](float, float) { return 0.0F; });
  RenderOptions clay;
  clay.longest_px = 64;
  RenderOptions reliability = clay;
  reliability.style = RenderStyle::kReliability;
  EXPECT_EQ(drawn(sheet, Face::kObverse, clay).bytes, drawn(sheet, Face::kObverse, reliability).bytes);
  sheet.reliability.assign(sheet.positions.size(), 0.0F);
  EXPECT_NE(drawn(sheet, Face::kObverse, clay).bytes, drawn(sheet, Face::kObverse, reliability).bytes);
}

TEST(Render, SaysPlainlyWhenThereIsNothingToDraw) {
  const Mesh nothing;
  const JobContext job;
  const auto image = render(RenderScene(nothing), face_camera(Face::kTop), {}, job);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(image.error().line(), "rendering: the mesh has no surface to draw; scan and stitch first");
}

TEST(Render, RefusesHugePicturesAndBadOptions) {
  Mesh mesh = coloured_box(4, 4, 4);
  const JobContext job;
  RenderOptions options;
  options.mm_per_px = 1e-6;
  auto image = render(RenderScene(mesh), face_camera(Face::kTop), options, job);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kUsage);
  options.mm_per_px = std::nan("");
  EXPECT_FALSE(render(RenderScene(mesh), face_camera(Face::kTop), options, job));
  options = {};
  options.supersampling = 9;
  EXPECT_FALSE(render(RenderScene(mesh), face_camera(Face::kTop), options, job));
  options = {};
  options.towards_lamp.setZero();
  EXPECT_FALSE(render(RenderScene(mesh), face_camera(Face::kTop), options, job));
}

TEST(Render, StopsWhenAsked) {
  const Mesh mesh = coloured_box(4, 4, 4);
  JobContext job;
  job.cancel();
  const auto image = render(RenderScene(mesh), face_camera(Face::kTop), {}, job);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace dubsar
