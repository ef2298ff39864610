// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/random.h"
#include "core/units.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/stitcher.h"

namespace dubsar::test {

inline constexpr double kRadius = 4.0;

/// A ball of kRadius seen by an orthographic scanner from `side` (0 to 5: the axes), turned by a little.
inline RangeGrid ball_grid(double spacing_mm, double noise_mm, std::uint64_t seed) {
  Random random(seed);
  const int n = static_cast<int>(2.4 * kRadius / spacing_mm);
  return height_grid(n, n, spacing_mm, [&](double x, double y) {
    const double z2 = kRadius * kRadius - x * x - y * y;
    return z2 < 0.5 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(z2) + noise_mm * random.normal();
  });
}

inline RigidTransform view_from(int side) {
  static const double kTurns[6][3] = {{0, 0, 0},        {kPi, 0, 0},     {kPi / 2, 0, 0},
                                      {-kPi / 2, 0, 0}, {0, kPi / 2, 0}, {0, -kPi / 2, 0}};
  const Eigen::Vector3d turn(kTurns[side][0], kTurns[side][1], kTurns[side][2]);
  return RigidTransform::from_twist(turn, {0, 0, 0}) *
         RigidTransform::from_twist({0.02 * side, -0.03, 0.3 * side}, {0, 0, 0});
}

/// Of six sides, noise of a seed for each.
inline ScanSet ball(double spacing_mm = 0.15, double noise_mm = 0.01) {
  ScanSet set;
  for (int side = 0; side < 6; ++side) {
    set.add(ball_grid(spacing_mm, noise_mm, static_cast<std::uint64_t>(side) + 1), view_from(side), 0.01);
  }
  return set;
}

inline Mesh stitched(const ScanSet& set) {
  JobContext job;
  Result<Mesh> mesh = stitch(set.placed, {}, job);
  EXPECT_TRUE(mesh.has_value()) << (mesh ? "" : mesh.error().line());
  return mesh ? std::move(*mesh) : Mesh{};
}

inline void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.reliability, b.reliability);
  EXPECT_EQ(a.sigma_mm, b.sigma_mm);
  EXPECT_EQ(a.scans, b.scans);
  EXPECT_EQ(a.flags, b.flags);
}

}  // namespace dubsar::test
