// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/outline.h"

#include <gtest/gtest.h>

#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

double area_of(const OutlineRing& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

TEST(Outline, OfABoxIsItsRectangle) {
  const Mesh box = coloured_box(40, 30, 10, 5, -2, 1);
  const auto rings = outline_of(RenderScene(box), face_camera(Face::kObverse), 400);
  ASSERT_TRUE(rings);
  ASSERT_EQ(rings->size(), 1U);
  EXPECT_LE(rings->front().size(), 8U);
  EXPECT_NEAR(area_of(rings->front()), 40 * 30, 12);
  for (const Eigen::Vector2d& p : rings->front()) {
    EXPECT_NEAR(std::abs(p.x() - 5), 20, 0.2);
    EXPECT_NEAR(std::abs(p.y() + 2), 15, 0.2);
  }
}

TEST(Outline, HasARingForEveryHoleTheOtherWayRound) {
  Mesh frame;
  const float a = 20;
  const float b = 8;
  const Rgb8 c{1, 2, 3};
  add_quad(frame, {{{-a, b, 0}, {a, b, 0}, {a, a, 0}, {-a, a, 0}}}, c);
  add_quad(frame, {{{-a, -a, 0}, {a, -a, 0}, {a, -b, 0}, {-a, -b, 0}}}, c);
  add_quad(frame, {{{-a, -b, 0}, {-b, -b, 0}, {-b, b, 0}, {-a, b, 0}}}, c);
  add_quad(frame, {{{b, -b, 0}, {a, -b, 0}, {a, b, 0}, {b, b, 0}}}, c);
  const auto rings = outline_of(RenderScene(frame), face_camera(Face::kObverse), 400);
  ASSERT_TRUE(rings);
  ASSERT_EQ(rings->size(), 2U);
  EXPECT_NEAR(area_of((*rings)[0]), 1600, 20);
  EXPECT_NEAR(area_of((*rings)[1]), -256, 8);
}

}  // namespace
}  // namespace dubsar
