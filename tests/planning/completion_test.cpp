// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/completion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/units.h"
#include "planning/convex_hull.h"

namespace dubsar {
namespace {

/// The part of an ellipsoid above z0 (half axes 15, 12, 6), as a mesh.
Mesh pebble_above(double z0) {
  constexpr int kRound = 60;
  constexpr int kDown = 40;
  Mesh mesh;
  const double last = std::acos(z0 / 6.0);
  for (int i = 0; i <= kDown; ++i) {
    for (int j = 0; j < kRound; ++j) {
      const double theta = last * (i + 0.01) / (kDown + 0.01);
      const double phi = 2 * kPi * j / kRound;
      mesh.positions.emplace_back(static_cast<float>(15 * std::sin(theta) * std::cos(phi)),
                                  static_cast<float>(12 * std::sin(theta) * std::sin(phi)),
                                  static_cast<float>(6 * std::cos(theta)));
    }
  }
  for (std::uint32_t i = 0; i < kDown; ++i) {
    for (std::uint32_t j = 0; j < kRound; ++j) {
      const std::uint32_t a = i * kRound + j;
      const std::uint32_t b = i * kRound + (j + 1) % kRound;
      mesh.faces.push_back({a, a + kRound, b});
      mesh.faces.push_back({b, a + kRound, b + kRound});
    }
  }
  return mesh;
}

double lowest(const std::vector<Eigen::Vector3d>& points) {
  double low = 1e9;
  for (const Eigen::Vector3d& p : points) {
    low = std::min(low, p.z());
  }
  return low;
}

std::vector<Eigen::Vector3d> mirrored(const Mesh& mesh) {
  const auto corners = hull_points(mesh.positions);
  return mirrored_points(mesh, convex_hull(corners), corners, ModelFaces{});
}

TEST(Completion, ATabletSeenFromAboveGetsItsOtherHalf) {
  EXPECT_NEAR(lowest(mirrored(pebble_above(0.3))), -6.0, 1.0);
}

TEST(Completion, SidesThatWereSeenTellWhereTheMiddleIs) {
  // Seen a good way down the far side: mirroring at the border would make it 3 mm too thick.
  EXPECT_NEAR(lowest(mirrored(pebble_above(-1.5))), -6.0, 1.0);
}

TEST(Completion, NothingIsAddedToWhatWasSeenFromBothEnds) {
  EXPECT_TRUE(mirrored(pebble_above(-5.99)).empty());
}

}  // namespace
}  // namespace dubsar
