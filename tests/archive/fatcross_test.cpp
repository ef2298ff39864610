// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/fatcross.h"

#include <gtest/gtest.h>

#include "archive/ruler.h"
#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

SixViews views_of(const Mesh& box, double mm_per_px) {
  SixViewOptions options;
  options.render.mm_per_px = mm_per_px;
  options.render.style = RenderStyle::kColours;
  options.render.margin_px = 0;
  options.render.background = kBlackGround;
  const JobContext job;
  auto views = render_six_views(RenderScene(box), options, job);
  EXPECT_TRUE(views);
  return std::move(*views);
}

Face face_at(const Image& image, int x, int y) {
  return static_cast<Face>(nearest_face_colour(image.rgb(x, y)));
}

TEST(Fatcross, OfCdliIsJoinedAndToScale) {
  const Mesh box = coloured_box(30, 24, 12);
  const Image sheet = fatcross(views_of(box, 0.1), FatcrossKind::kCdli, kBlackGround);
  EXPECT_DOUBLE_EQ(sheet.mm_per_px, 0.1);
  EXPECT_NEAR(sheet.width, 120 + 300 + 120, 3);
  ASSERT_GE(sheet.height, 120 + 240 + 120 + 240);
  const int column = 120 + 70;
  EXPECT_EQ(face_at(sheet, column, 60), Face::kTop);
  EXPECT_EQ(face_at(sheet, column, 120 + 180), Face::kObverse);
  EXPECT_EQ(face_at(sheet, column, 360 + 60), Face::kBottom);
  EXPECT_EQ(face_at(sheet, column, 480 + 180), Face::kReverse);
  EXPECT_EQ(face_at(sheet, 60, 120 + 120), Face::kLeft);
  EXPECT_EQ(face_at(sheet, 420 + 60, 120 + 120), Face::kRight);
  EXPECT_EQ(sheet.rgb(10, 10), kBlackGround);
}

TEST(Fatcross, OfEblHasGapsAndARulerBelow) {
  const Mesh box = coloured_box(60, 24, 12);
  const double mm_per_px = 25.4 / 600;
  const Image sheet = fatcross(views_of(box, mm_per_px), FatcrossKind::kEbl, kBlackGround);
  const auto px = [&](double mm) { return static_cast<int>(mm / mm_per_px); };
  EXPECT_NEAR(sheet.width, 4 * 100 + px(12) + px(60) + px(12), 4);
  const int column = 200 + px(12) + px(14);
  EXPECT_EQ(face_at(sheet, column, 100 + px(18)), Face::kObverse);
  EXPECT_EQ(face_at(sheet, column, 200 + px(24 + 6)), Face::kBottom);
  EXPECT_EQ(face_at(sheet, column, 300 + px(36 + 18)), Face::kReverse);
  EXPECT_EQ(face_at(sheet, column, 400 + px(60 + 6)), Face::kTop);
  // The ruler: five white and black centimetres, exactly as long as five centimetres of the tablet.
  const int row = sheet.height - 100 - ruler_for(mm_per_px, px(60)).height_px + px(3);
  int first = -1;
  int last = -1;
  for (int x = 0; x < sheet.width; ++x) {
    if (sheet.rgb(x, row) != kBlackGround) {
      first = first < 0 ? x : first;
      last = x;
    }
  }
  EXPECT_NEAR(last - first + 1, 50 / mm_per_px, 1);
}

/// A fragment of a centimetre: the ruler has no room in its column, and reaches below the edges.
TEST(Fatcross, OfANarrowFragmentHasARulerToo) {
  const double mm_per_px = 25.4 / 600;
  const SixViews views = views_of(coloured_box(10, 24, 6), mm_per_px);
  ASSERT_EQ(ruler_for(mm_per_px, views[Face::kObverse].width).length_cm, 0);
  for (const FatcrossKind kind : {FatcrossKind::kCdli, FatcrossKind::kEbl}) {
    const Image sheet = fatcross(views, kind, kBlackGround);
    const auto corners = fatcross_corners(views, kind);
    int below = 0;  // the first row below all views
    for (const Face face : kSixViewOrder) {
      below = std::max(below, corners[static_cast<std::size_t>(face)].y() + views[face].height);
    }
    int longest = 0;
    for (int y = below; y < sheet.height; ++y) {
      for (int x = 0, run = 0; x < sheet.width; ++x) {
        run = sheet.rgb(x, y) == kBlackGround ? 0 : run + 1;
        longest = std::max(longest, run);
      }
    }
    EXPECT_NEAR(longest, 10 * (kind == FatcrossKind::kEbl ? 2 : 1) / mm_per_px, 1);
  }
}

TEST(Fatcross, TellsWhereEachViewLies) {
  const SixViews views = views_of(coloured_box(30, 24, 12), 0.1);
  for (const FatcrossKind kind : {FatcrossKind::kCdli, FatcrossKind::kEbl}) {
    const Image sheet = fatcross(views, kind, kBlackGround);
    const auto corners = fatcross_corners(views, kind);
    for (const Face face : kSixViewOrder) {
      const Image& view = views[face];
      const Eigen::Vector2i& at = corners[static_cast<std::size_t>(face)];
      for (const auto& [x, y] : {std::pair{0, 0}, {view.width - 1, 0}, {view.width / 2, view.height - 1}}) {
        EXPECT_EQ(sheet.rgb(at.x() + x, at.y() + y), view.rgb(x, y)) << to_string(face);
      }
    }
  }
}

TEST(Ruler, IsTheLongestThatHasRoom) {
  EXPECT_EQ(ruler_for(0.1, 900).length_cm, 5);
  EXPECT_EQ(ruler_for(0.1, 400).length_cm, 2);
  EXPECT_EQ(ruler_for(0.1, 220).length_cm, 1);
  EXPECT_EQ(ruler_for(0.1, 50).length_cm, 0);
  EXPECT_EQ(ruler_for(0, 500).length_cm, 0);
}

}  // namespace
}  // namespace dubsar
