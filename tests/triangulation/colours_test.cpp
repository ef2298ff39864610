// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Colours that scanners give reach the mesh.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/triangulation/support/ball_scans.h"

namespace dubsar {
namespace {

constexpr double kMu = 0.1;

std::array<std::uint8_t, 3> colour_at(double x) {
  return {static_cast<std::uint8_t>(std::lround(120 + 20 * x)), 90, 60};
}

/// 61 x 61 samples of a plane, redder to the right, with a hole of one sample and one of 2 x 5.
RangeGrid coloured_plate() {
  RangeGrid grid = test::height_grid(61, 61, kMu, [](double x, double y) {
    const bool hole =
        (std::abs(x) < 0.05 && std::abs(y) < 0.05) || (std::abs(x - 1) < 0.25 && std::abs(y - 1.05) < 0.1);
    return hole ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  });
  grid.rgb.resize(3 * grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    std::ranges::copy(colour_at(grid.x[i]), grid.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return grid;
}

TEST(Colours, OfSamplesAreThoseOfTheirVerticesAndWhatFillsAGapBlends) {
  test::ScanSet set;
  set.add(coloured_plate(), {});
  const Mesh mesh = test::stitched(set);
  ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
  std::size_t filled = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const bool interpolated = (mesh.flags[v] & kVertexInterpolated) != 0;
    filled += interpolated ? 1 : 0;
    EXPECT_NEAR(mesh.colours[v][0], colour_at(mesh.positions[v].x())[0], interpolated ? 4 : 0);
    EXPECT_EQ(mesh.colours[v][1], 90);
    EXPECT_EQ(mesh.colours[v][2], 60);
  }
  EXPECT_GT(filled, 0U);
}

TEST(Colours, WhereAScanWithoutAnyIsPrimaryItIsGrey) {
  test::ScanSet set;
  set.add(coloured_plate(), {});
  RigidTransform aside;
  aside.translation_mm = {4, 0, 0};
  set.add(test::height_grid(61, 61, kMu, [](double, double) { return 0.0; }), aside);
  const Mesh mesh = test::stitched(set);
  ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
  constexpr std::array<std::uint8_t, 3> kGrey = {128, 128, 128};
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const float x = mesh.positions[v].x();
    if (x > 3.1F) {
      EXPECT_EQ(mesh.colours[v], kGrey);
    } else if (x < 0.8F) {
      EXPECT_NE(mesh.colours[v], kGrey);
    }
  }
}

TEST(Colours, OfScansWithoutAnyTheMeshHasNone) {
  EXPECT_TRUE(test::stitched(test::ball()).colours.empty());
}

}  // namespace
}  // namespace dubsar
