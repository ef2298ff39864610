// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/cross_section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dubsar {
namespace {

/// A field with a V-shaped groove along y, 2 mm wide and 1 mm deep, over x = 0; and its underside.
Mesh groove(double step, bool underside) {
  Mesh mesh;
  const int side = static_cast<int>(std::lround(10 / step));
  const auto add_sheet = [&](double z0, bool up) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int r = 0; r <= side; ++r) {
      for (int c = 0; c <= side; ++c) {
        const double x = -5 + step * c;
        const double depth = up ? std::max(0.0, 1 - std::abs(x)) : 0;
        mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(-5 + step * r),
                                    static_cast<float>(z0 - depth));
      }
    }
    const auto at = [&](int r, int c) { return first + static_cast<std::uint32_t>(r * (side + 1) + c); };
    for (int r = 0; r < side; ++r) {
      for (int c = 0; c < side; ++c) {
        std::array<std::uint32_t, 3> a{at(r, c), at(r, c + 1), at(r + 1, c + 1)};
        std::array<std::uint32_t, 3> b{at(r, c), at(r + 1, c + 1), at(r + 1, c)};
        if (!up) {
          std::swap(a[1], a[2]);
          std::swap(b[1], b[2]);
        }
        mesh.faces.push_back(a);
        mesh.faces.push_back(b);
      }
    }
  };
  add_sheet(3, true);
  if (underside) {
    add_sheet(-3, false);
  }
  return mesh;
}

TEST(CrossSection, AGrooveHasItsDepthWhereItIs) {
  for (const bool underside : {false, true}) {
    const Result<CrossSection> cut =
        cross_section(groove(0.1, underside), {-3.03, 0.04, 3}, {3.01, 0.04, 3}, {0, 0, 2});
    ASSERT_TRUE(cut.has_value());
    ASSERT_EQ(cut->lines.size(), 1U) << "the underside looks away";
    EXPECT_NEAR(cut->length_mm, 6.04, 1e-6);
    EXPECT_NEAR(cut->lowest_mm, -1, 1e-5);
    EXPECT_NEAR(cut->lowest_along_mm, 3.03, 0.11);
    EXPECT_NEAR(cut->highest_mm, 0, 1e-5);
    EXPECT_NEAR(cut->lines[0].front().along_mm, 0, 1e-9);
    EXPECT_NEAR(cut->lines[0].back().along_mm, 6.04, 1e-6);
    for (std::size_t k = 1; k < cut->lines[0].size(); ++k) {
      EXPECT_GE(cut->lines[0][k].along_mm, cut->lines[0][k - 1].along_mm);
    }
    for (const auto& point : cut->lines[0]) {
      EXPECT_NEAR(point.place_mm.y(), 0.04, 1e-9);
      EXPECT_NEAR(point.height_mm, -std::max(0.0, 1 - std::abs(point.place_mm.x())), 1e-5);
    }
  }
}

TEST(CrossSection, HeightsAreOverTheLineBetweenThePlaces) {
  // Both places on the flanks of the groove: the line between them hangs in it.
  const Result<CrossSection> cut = cross_section(groove(0.1, false), {-0.5, 0, 2.5}, {2, 0.5, 3}, {0, 0, 1});
  ASSERT_TRUE(cut.has_value());
  ASSERT_FALSE(cut->lines.empty());
  EXPECT_NEAR(cut->lines[0].front().height_mm, 0, 1e-5);
  EXPECT_NEAR(cut->lines[0].back().height_mm, 0, 1e-5);
}

/// Whichever way it is looked at: a section is true to scale, not its picture.
TEST(CrossSection, IsTheSameFromEverySideThatItIsSeenFrom) {
  const Mesh mesh = groove(0.1, false);
  const Result<CrossSection> straight = cross_section(mesh, {-3, 0, 3}, {3, 0, 3}, {0, 0, 1});
  ASSERT_TRUE(straight.has_value());
  for (const double lean : {-0.9, -0.3, 0.5}) {
    const Result<CrossSection> cut = cross_section(mesh, {-3, 0, 3}, {3, 0, 3}, {lean, 0, 1});
    ASSERT_TRUE(cut.has_value());
    EXPECT_NEAR(cut->length_mm, 6, 1e-9) << lean;
    EXPECT_NEAR(cut->lowest_mm, -1, 1e-5) << lean;
    EXPECT_NEAR(cut->lowest_along_mm, 3, 1e-5) << lean;
    ASSERT_EQ(cut->lines.size(), 1U) << lean;
    EXPECT_EQ(cut->lines[0].size(), straight->lines[0].size()) << lean;
  }
}

TEST(CrossSection, OfPlacesAtDifferentHeightsIsTrueToScale) {
  // From the field down to the bottom of the groove: the flank rises over that line by a known distance.
  const Result<CrossSection> cut = cross_section(groove(0.1, false), {-3, 0, 3}, {0, 0, 2}, {0, 0, 1});
  ASSERT_TRUE(cut.has_value());
  EXPECT_NEAR(cut->length_mm, std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(cut->highest_mm, 2 / std::sqrt(10.0), 1e-5);  // the rim at (-1, 3)
  for (const auto& line : cut->lines) {
    for (const CrossSection::Point& p : line) {
      EXPECT_NEAR(std::hypot(p.along_mm, p.height_mm), (p.place_mm - Eigen::Vector3d(-3, 0, 3)).norm(), 1e-6);
    }
  }
}

TEST(CrossSection, WhatLiesBehindIsNotCut) {
  Mesh mesh = groove(0.1, false);
  const Mesh plate = groove(0.25, false);  // another groove, under the middle of this one
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Eigen::Vector3f& p : plate.positions) {
    mesh.positions.push_back(1.6F * p - Eigen::Vector3f(0, 0, 8));
  }
  for (const auto& face : plate.faces) {
    mesh.faces.push_back({first + face[0], first + face[1], first + face[2]});
  }
  const Result<CrossSection> cut = cross_section(mesh, {-3, 0.04, 3}, {3, 0.04, 3}, {0, 0, 1});
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->lines.size(), 1U);
  EXPECT_NEAR(cut->lowest_mm, -1, 1e-5);
  // Beside the upper one the lower one is seen.
  const Result<CrossSection> wide = cross_section(mesh, {-7, 0.04, 3}, {7, 0.04, 3}, {0, 0, 1});
  ASSERT_TRUE(wide.has_value());
  ASSERT_EQ(wide->lines.size(), 3U);
  EXPECT_NEAR(wide->lines[0].back().place_mm.x(), -5, 0.5);
  EXPECT_NEAR(wide->lines[2].front().place_mm.x(), 5, 0.5);
}

TEST(CrossSection, AHolePartsIt) {
  Mesh mesh = groove(0.1, false);
  std::erase_if(mesh.faces, [&](const auto& face) {
    const Eigen::Vector3f& p = mesh.positions[face[0]];
    return p.x() > 1.5F && p.x() < 2.2F;
  });
  const Result<CrossSection> cut = cross_section(mesh, {-3, 0.04, 3}, {4, 0.04, 3}, {0, 0, 1});
  ASSERT_TRUE(cut.has_value());
  ASSERT_EQ(cut->lines.size(), 2U);
  EXPECT_LT(cut->lines[0].back().along_mm, cut->lines[1].front().along_mm);
}

TEST(CrossSection, RefusesWhatIsNoCutAndFindsNothingBesideTheMesh) {
  const Mesh mesh = groove(0.5, false);
  EXPECT_FALSE(cross_section(mesh, {0, 0, 1}, {0, 0, 3}, {0, 0, 1}).has_value());
  EXPECT_FALSE(cross_section(mesh, {0, 0, 1}, {1, 0, 3}, {0, 0, 0}).has_value());
  EXPECT_FALSE(cross_section(mesh, {0, std::nan(""), 1}, {1, 0, 3}, {0, 0, 1}).has_value());
  const Result<CrossSection> beside = cross_section(mesh, {0, 50, 3}, {3, 50, 3}, {0, 0, 1});
  ASSERT_TRUE(beside.has_value());
  EXPECT_TRUE(beside->lines.empty());
}

}  // namespace
}  // namespace dubsar
