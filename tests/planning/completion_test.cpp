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
  return mirrored_points(mesh, MeshQuery(mesh), convex_hull(corners), corners, ModelFaces{});
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

/// The side of a cone upon its base (radius 12 at z -10), up to z_mm, where it would come to a point at z 10.
Mesh cone_up_to(double z_mm) {
  constexpr std::uint32_t kRound = 60;
  constexpr std::uint32_t kUp = 40;
  Mesh mesh;
  for (std::uint32_t i = 0; i <= kUp; ++i) {
    for (std::uint32_t j = 0; j < kRound; ++j) {
      const double z = -10 + (z_mm + 10) * i / kUp;
      const double phi = 2 * kPi * j / kRound;
      const double radius = 0.6 * (10 - z);
      mesh.positions.emplace_back(static_cast<float>(radius * std::cos(phi)),
                                  static_cast<float>(radius * std::sin(phi)), static_cast<float>(z));
    }
  }
  mesh.positions.emplace_back(0.0F, 0.0F, -10.0F);
  for (std::uint32_t j = 0; j < kRound; ++j) {
    mesh.faces.push_back({(kUp + 1) * kRound, (j + 1) % kRound, j});
    for (std::uint32_t i = 0; i < kUp; ++i) {
      const std::uint32_t a = i * kRound + j;
      const std::uint32_t b = i * kRound + (j + 1) % kRound;
      mesh.faces.push_back({a, b, a + kRound});
      mesh.faces.push_back({b, b + kRound, a + kRound});
    }
  }
  return mesh;
}

TEST(Completion, AConeEndsAtItsTip) {
  EXPECT_TRUE(mirrored(cone_up_to(9.9)).empty()) << "it would get another base in the air";
  EXPECT_FALSE(mirrored(cone_up_to(-2)).empty()) << "what is above was not seen";
}

}  // namespace
}  // namespace dubsar
