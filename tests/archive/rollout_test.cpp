// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/rollout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
  const auto flat = rolled_out(scene, {}, job);
  ASSERT_TRUE(flat) << flat.error().line();
  ASSERT_EQ(flat->positions.size(), round.positions.size());
  EXPECT_NEAR(static_cast<double>(flat->faces.size()), static_cast<double>(round.faces.size()), 20)
      << "only those at the seam are gone";
  double low = 0;
  for (std::size_t v = 0; v < flat->positions.size(); ++v) {
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

TEST(Rollout, HasNothingToRollWithoutASurface) {
  const Mesh nothing;
  const JobContext job;
  EXPECT_EQ(rolled_out(RenderScene(nothing), {}, job).error().kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace dubsar
