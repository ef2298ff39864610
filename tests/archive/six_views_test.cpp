// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/six_views.h"

#include <gtest/gtest.h>

#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

SixViewOptions sheet_options() {
  SixViewOptions options;
  options.render.mm_per_px = 0.1;
  options.render.style = RenderStyle::kColours;
  options.render.margin_px = 0;
  options.gap_px = 4;
  options.scale_bar = false;
  return options;
}

TEST(SixViewSheet, LaysTheFacesOutRoundTheObverse) {
  const Mesh box = coloured_box(10, 8, 4);
  const JobContext job;
  const auto sheet = render_six_view_sheet(RenderScene(box), sheet_options(), job);
  ASSERT_TRUE(sheet) << sheet.error().line();
  EXPECT_NEAR(sheet->width, 4 * 4 + 40 + 100 + 40, 3);
  EXPECT_NEAR(sheet->height, 5 * 4 + 40 + 80 + 40 + 80, 3);
  EXPECT_DOUBLE_EQ(sheet->mm_per_px, 0.1);
  const int column = 48 + 25;  // a quarter into the column: clear of the marks
  const auto face_at = [&](int x, int y) { return static_cast<Face>(nearest_face_colour(sheet->rgb(x, y))); };
  EXPECT_EQ(face_at(column, 4 + 20), Face::kTop);
  EXPECT_EQ(face_at(column, 48 + 60), Face::kObverse);
  EXPECT_EQ(face_at(column, 48 + 80 + 4 + 20), Face::kBottom);
  EXPECT_EQ(face_at(column, 48 + 80 + 8 + 40 + 60), Face::kReverse);
  EXPECT_EQ(face_at(4 + 20, 48 + 40), Face::kLeft);
  EXPECT_EQ(face_at(48 + 100 + 4 + 20, 48 + 40), Face::kRight);
  EXPECT_EQ(sheet->rgb(10, 10), kPaper) << "corners are empty";
}

TEST(SixViewSheet, JoinsTheViewsOnABlackGround) {
  const Mesh box = coloured_box(10, 8, 4);
  SixViewOptions options = sheet_options();
  options.gap_px = 0;
  options.render.background = kBlackGround;
  const JobContext job;
  const auto sheet = render_six_view_sheet(RenderScene(box), options, job);
  ASSERT_TRUE(sheet);
  EXPECT_NEAR(sheet->width, 180, 3);
  EXPECT_NEAR(sheet->height, 240, 3);
  EXPECT_EQ(sheet->rgb(0, 0), kBlackGround);
}

TEST(SixViewSheet, HasRoomForItsScaleBar) {
  const JobContext job;
  for (const float thickness : {0.5F, 30.0F}) {
    const Mesh box = coloured_box(50, 40, thickness);
    SixViewOptions options = sheet_options();
    const RenderScene scene(box);
    const auto bare = render_six_view_sheet(scene, options, job);
    options.scale_bar = true;
    const auto ruled = render_six_view_sheet(scene, options, job);
    ASSERT_TRUE(bare && ruled);
    int inked = 0;
    for (int y = 0; y < ruled->height; ++y) {
      for (int x = 0; x < ruled->width; ++x) {
        const bool was_paper = y >= bare->height || bare->rgb(x, y) == kPaper;
        const bool changed =
            y >= bare->height ? ruled->rgb(x, y) != kPaper : ruled->rgb(x, y) != bare->rgb(x, y);
        inked += changed ? 1 : 0;
        EXPECT_TRUE(!changed || was_paper) << "the bar covers clay at " << x << ", " << y;
      }
    }
    EXPECT_GT(inked, 100) << thickness;
  }
}

TEST(SixViews, PassesErrorsOn) {
  const Mesh nothing;
  const JobContext job;
  EXPECT_FALSE(render_six_views(RenderScene(nothing), {}, job));
}

}  // namespace
}  // namespace dubsar
