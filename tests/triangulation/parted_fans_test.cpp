// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "core/random.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

/// Formats without indices, as STL, know vertices by their places alone.
TEST(PartedFans, DoNotTouch) {
  Random random(8);
  test::ScanSet set;
  for (int side = 0; side < 3; ++side) {
    RangeGrid grid = test::height_grid(90, 90, 0.1, [&](double, double) { return 0.09 * random.normal(); });
    for (std::uint8_t& valid : grid.valid) {
      valid = random.uniform() < 0.7 ? 1 : 0;
    }
    set.add(std::move(grid), {});
  }
  const Result<Mesh> mesh = stitch(set.placed, {}, JobContext());
  ASSERT_TRUE(mesh) << mesh.error().line();
  ASSERT_GT(mesh->faces.size(), 500U);
  std::set<std::array<float, 3>> places;
  for (const Eigen::Vector3f& p : mesh->positions) {
    places.insert({p.x(), p.y(), p.z()});
  }
  EXPECT_EQ(places.size(), mesh->positions.size());
}

}  // namespace
}  // namespace dubsar
