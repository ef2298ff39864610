// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "core/random.h"
#include "formats/mesh_io.h"
#include "tests/support/temporary_folder.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/mesh_check.h"
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

/// Pairs of vertices that lie nearer to each other than a thirtieth of the spacing.
std::size_t parted(const Mesh& mesh, double spacing_mm) {
  std::size_t pairs = 0;
  std::vector<Eigen::Vector3f> by_x = mesh.positions;
  std::ranges::sort(by_x, {}, [](const Eigen::Vector3f& p) { return p.x(); });
  const auto near_mm = static_cast<float>(spacing_mm / 30);
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    for (std::size_t b = a + 1; b < by_x.size() && by_x[b].x() - by_x[a].x() < near_mm; ++b) {
      pairs += (by_x[b] - by_x[a]).norm() < near_mm ? 1 : 0;
    }
  }
  return pairs;
}

/// A file of whole steps joins what lies less than one apart.
TEST(PartedFans, DoNotTouchInACompressedFile) {
  const test::TemporaryFolder folder;
  constexpr int kSide = 200;
  for (const auto& [spacing_mm, away_mm] : {std::pair(0.005, 0.0), {0.02, 300.0}}) {
    SCOPED_TRACE(away_mm);
    Random random(9);
    test::ScanSet set;
    for (int k = 0; k < 3; ++k) {
      RangeGrid grid = test::height_grid(kSide, kSide, spacing_mm,
                                         [&](double, double) { return 0.9 * spacing_mm * random.normal(); });
      for (std::uint8_t& valid : grid.valid) {
        valid = random.uniform() < 0.6 ? 1 : 0;
      }
      set.add(std::move(grid),
              RigidTransform::from_twist({0, 0, 0}, {0.3 * k * spacing_mm, 0.2 * k * spacing_mm, away_mm}));
    }
    const Result<Mesh> mesh = stitch(set.placed, {}, JobContext());
    ASSERT_TRUE(mesh) << mesh.error().line();
    EXPECT_GT(parted(*mesh, spacing_mm), 2U);
    ASSERT_TRUE(write_mesh(folder.path() / "a.draco.glb", *mesh));
    const Result<Mesh> back = read_mesh(folder.path() / "a.draco.glb");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->positions.size(), mesh->positions.size());
    EXPECT_TRUE(check_manifold(*back).is_manifold());
  }
}

}  // namespace
}  // namespace dubsar
