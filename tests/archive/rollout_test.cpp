// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rollout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "archive/scale_bar.h"
#include "archive/side_curve.h"
#include "tests/archive/shapes.h"

namespace dubsar {
namespace {

/// A tube along x without ends, radius in mm, faces outwards.
Mesh tube(double radius, double length, int around, int along) {
  Mesh mesh;
  for (int i = 0; i <= along; ++i) {
    for (int k = 0; k < around; ++k) {
      const double a = 2 * std::numbers::pi * k / around;
      mesh.positions.emplace_back(length * (static_cast<double>(i) / along - 0.5), radius * std::cos(a),
                                  radius * std::sin(a));
    }
  }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * around + k % around); };
  for (int i = 0; i < along; ++i) {
    for (int k = 0; k < around; ++k) {
      mesh.faces.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
      mesh.faces.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
    }
  }
  return mesh;
}

TEST(SideCurve, GoesRoundFromBetweenTopEdgeAndObverse) {
  std::vector<Eigen::Vector2f> square = {{20, 10}, {-20, 10}, {-20, -10}, {20, -10}, {3, 2}};
  const SideCurve curve(square);
  ASSERT_FALSE(curve.empty());
  EXPECT_NEAR(curve.length_mm(), 120, 8) << "rounded corners are shorter";
  const auto obverse = curve.place({0, 10.5});
  const auto bottom = curve.place({-20, 0});
  const auto reverse = curve.place({0, -9});
  const auto top = curve.place({20, 0});
  EXPECT_LT(obverse.along_mm, bottom.along_mm);
  EXPECT_LT(bottom.along_mm, reverse.along_mm);
  EXPECT_LT(reverse.along_mm, top.along_mm);
  EXPECT_NEAR(obverse.off_mm, 0.5, 1e-3);
  EXPECT_NEAR(reverse.off_mm, -1, 1e-3);
  EXPECT_NEAR(reverse.outward.y(), -1, 1e-6);
  EXPECT_NEAR(reverse.along_mm - obverse.along_mm, curve.length_mm() / 2, 0.1);
  EXPECT_TRUE(SideCurve({{0, 0}, {1, 1}, {2, 2}}).empty());
}

TEST(Rollout, IsToScaleAlongTheCurve) {
  const double radius = 12;
  const Mesh round = tube(radius, 40, 360, 10);
  const JobContext job;
  const RenderScene scene(round);
  const auto rollout = rolled_out(scene, {}, job);
  ASSERT_TRUE(rollout) << rollout.error().line();
  const Mesh* const flat = &rollout->mesh;
  double low = 0;
  for (std::size_t v = 0; v < round.positions.size(); ++v) {
    EXPECT_FLOAT_EQ(flat->positions[v].x(), round.positions[v].x());
    EXPECT_NEAR(flat->positions[v].z(), 0, 0.4) << "the smoothed curve lies a little inside";
    EXPECT_NEAR(flat->normals[v].z(), 1, 1e-3);
    low = std::min(low, static_cast<double>(flat->positions[v].y()));
  }
  EXPECT_NEAR(-low, 2 * std::numbers::pi * radius, 2.5);
  // A face that looked outwards looks at the viewer.
  for (const auto& f : flat->faces) {
    const Eigen::Vector3f a = flat->positions[f[0]];
    const Eigen::Vector3f ab = flat->positions[f[1]] - a;
    const Eigen::Vector3f ac = flat->positions[f[2]] - a;
    EXPECT_GT(ab.x() * ac.y() - ab.y() * ac.x(), 0);
  }
}

TEST(SideCurve, HasTheLengthsOfTheOutlineWhereThatIsRound) {
  std::vector<Eigen::Vector2f> slab;  // 40 mm long, 10 mm thick, its ends half circles
  for (int k = 0; k <= 180; ++k) {
    const double a = std::numbers::pi * k / 180;
    slab.push_back(Eigen::Vector2d(15 + 5 * std::sin(a), 5 * std::cos(a)).cast<float>());
    slab.push_back(Eigen::Vector2d(-15 - 5 * std::sin(a), 5 * std::cos(a)).cast<float>());
  }
  const SideCurve curve(slab);
  EXPECT_NEAR(curve.length_mm(), 60 + 10 * std::numbers::pi, 0.1);
  const double round_mm = curve.place({-15, -5}).along_mm - curve.place({-15, 5}).along_mm;
  EXPECT_NEAR(round_mm, 5 * std::numbers::pi, 0.1) << "14.7 along what the rounding leaves of it";
  EXPECT_NEAR(curve.place({-10, 5}).along_mm - curve.place({10, 5}).along_mm, 20, 0.02);
}

TEST(Rollout, OfASealIsAsLongAsTheWayRoundIt) {
  const double radius = 4;
  const Mesh seal = tube(radius, 20, 360, 4);
  const auto rollout = rolled_out(RenderScene(seal), {}, JobContext());
  ASSERT_TRUE(rollout) << rollout.error().line();
  float low = 0;
  for (const Eigen::Vector3f& p : rollout->mesh.positions) {
    low = std::min(low, p.y());
  }
  EXPECT_NEAR(-static_cast<double>(low), 2 * std::numbers::pi * radius, 0.1);
}

double area_mm2(const Mesh& flat) {
  double twice = 0;
  for (const auto& f : flat.faces) {
    const Eigen::Vector3f ab = flat.positions[f[1]] - flat.positions[f[0]];
    const Eigen::Vector3f ac = flat.positions[f[2]] - flat.positions[f[0]];
    twice += static_cast<double>(ab.x() * ac.y() - ab.y() * ac.x());
  }
  return 0.5 * twice;
}

TEST(Rollout, EndsStraightAtBothEnds) {
  const Mesh round = tube(12, 40, 100, 7);  // its rows lie beside the seam
  const JobContext job;
  const auto rollout = rolled_out(RenderScene(round), {}, job);
  ASSERT_TRUE(rollout) << rollout.error().line();
  const Mesh& flat = rollout->mesh;
  float low = 0;
  float high = -1e9F;
  for (const auto& f : flat.faces) {
    for (const std::uint32_t v : f) {
      low = std::min(low, flat.positions[v].y());
      high = std::max(high, flat.positions[v].y());
    }
  }
  EXPECT_EQ(high, 0);
  EXPECT_NEAR(area_mm2(flat), 40.0 * static_cast<double>(high - low), 0.01)
      << "each face is there once, and those at the seam are cut";
}

TEST(Rollout, SaysWhereSidesBegin) {
  const Mesh round = tube(12, 40, 360, 10);
  const JobContext job;
  const auto rollout = rolled_out(RenderScene(round), {}, job);
  ASSERT_TRUE(rollout) << rollout.error().line();
  float low = 0;
  for (const Eigen::Vector3f& p : rollout->mesh.positions) {
    low = std::min(low, p.y());
  }
  const double quarter = -0.25 * static_cast<double>(low);
  constexpr std::array kDown = {Face::kObverse, Face::kBottom, Face::kReverse, Face::kTop};
  for (std::size_t k = 0; k < kDown.size(); ++k) {
    EXPECT_EQ(rollout->sides[k].face, kDown[k]);
    EXPECT_NEAR(rollout->sides[k].from_mm, static_cast<double>(k) * quarter, 0.1);
  }
}

TEST(Rollout, LeavesOutWhatItWouldStretch) {
  Mesh broken = tube(12, 40, 360, 40);
  const auto inside = [](const Eigen::Vector3f& p) { return p.x() > 5; };  // broken off there
  for (Eigen::Vector3f& p : broken.positions) {
    if (inside(p)) {
      p.y() *= 3.0F / 12;
      p.z() *= 3.0F / 12;
    }
  }
  const JobContext job;
  const auto rollout = rolled_out(RenderScene(broken), {}, job);
  ASSERT_TRUE(rollout) << rollout.error().line();
  std::size_t whole = 0;
  for (const auto& f : rollout->mesh.faces) {
    const auto x = [&](std::size_t k) { return rollout->mesh.positions[f[k]].x(); };
    EXPECT_LT(std::min({x(0), x(1), x(2)}), 5.01F) << "four times as long as it is";
    whole += std::max({x(0), x(1), x(2)}) < 5.01F ? 1 : 0;
  }
  EXPECT_GE(whole, 2U * 360 * 25);
}

TEST(Rollout, HasTicksAndABarBesideThePicture) {
  const Mesh round = tube(12, 40, 360, 40);
  const JobContext job;
  const RenderScene scene(round);
  RenderOptions options;
  options.mm_per_px = 0.1;
  options.margin_px = 0;
  options.background = kBlackGround;
  const auto rollout = rolled_out(scene, {}, job);
  ASSERT_TRUE(rollout);
  const auto bare = render(RenderScene(rollout->mesh), rollout_camera(), options, job);
  const auto picture = rollout_picture(scene, {}, options, job);
  ASSERT_TRUE(bare && picture);
  ASSERT_EQ(picture->height, bare->height + scale_bar_rows(0.1));
  ASSERT_GT(picture->width, bare->width);
  EXPECT_DOUBLE_EQ(picture->mm_per_px, 0.1);
  for (int y = 0; y < bare->height; ++y) {
    for (int x = 0; x < bare->width; ++x) {
      ASSERT_EQ(picture->rgb(x, y), bare->rgb(x, y)) << "where it was";
    }
  }
  const auto inked = [&](int x, int y) { return picture->rgb(x, y) != kBlackGround; };
  for (const RolloutSide& side : rollout->sides) {
    const int row = static_cast<int>(std::lround(side.from_mm / 0.1));
    int columns = 0;
    for (int x = bare->width; x < picture->width; ++x) {
      columns += inked(x, row) || inked(x, std::min(row + 1, bare->height - 1)) ? 1 : 0;
    }
    EXPECT_GT(columns, 8) << to_string(side.face);
  }
}

TEST(Rollout, HasNothingToRollWithoutASurface) {
  const Mesh nothing;
  const JobContext job;
  EXPECT_EQ(rolled_out(RenderScene(nothing), {}, job).error().kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace dubsar
