// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a mesh says of its vertices beside where they lie: which are on its boundary, and how many scans
// support them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/random.h"
#include "tests/triangulation/support/ball_scans.h"

namespace dubsar {
namespace {

/// The ends of the edges that one face alone has, [V].
std::vector<std::uint8_t> ends_of_open_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> faces_at;
  for (const auto& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++faces_at[std::minmax(f[k], f[(k + 1) % 3])];
    }
  }
  std::vector<std::uint8_t> out(mesh.positions.size(), 0);
  for (const auto& [edge, faces] : faces_at) {
    if (faces == 1) {
      out[edge.first] = out[edge.second] = 1;
    }
  }
  return out;
}

TEST(VertexMarks, ThoseOnTheBoundaryAndNoOthersAreMarkedSo) {
  test::ScanSet set = test::ball();
  set.placed.erase(set.placed.begin() + 1);  // nobody looked from below
  const Mesh mesh = test::stitched(set);
  const std::vector<std::uint8_t> open = ends_of_open_edges(mesh);
  ASSERT_EQ(mesh.flags.size(), open.size());
  // The sides see the ball up to where it falls off by 70 to 80 degrees: 6 to 11 mm around, µ 0.15 mm.
  EXPECT_GT(std::ranges::count(open, std::uint8_t{1}), 20);
  for (std::size_t v = 0; v < open.size(); ++v) {
    EXPECT_EQ((mesh.flags[v] & kVertexBoundary) != 0, open[v] != 0) << v;
  }
}

/// Three plates of 6 x 6 mm in a row, each 2 mm farther to the right: one scan, two, three, two and one.
TEST(VertexMarks, AsManyScansSupportAVertexAsSawItsPlace) {
  test::ScanSet set;
  for (int k = 0; k < 3; ++k) {
    Random random(static_cast<std::uint64_t>(k) + 1);  // else they were one scan and its copies
    set.add(test::height_grid(61, 61, 0.1, [&](double, double) { return 0.005 * random.normal(); }),
            {Eigen::Matrix3d::Identity(), {2.0 * k, 0, 0}});
  }
  const Mesh mesh = test::stitched(set);
  ASSERT_EQ(mesh.scans.size(), mesh.positions.size());
  for (const auto& [middle_mm, scans] : {std::pair(-2.0F, 1), {0.0F, 2}, {2.0F, 3}, {4.0F, 2}, {6.0F, 1}}) {
    double all = 0;
    double right = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Eigen::Vector3f& p = mesh.positions[v];
      // Six samples from each rim: nearer to one a scan fades out.
      if (std::abs(p.x() - middle_mm) < 0.4F && std::abs(p.y()) < 2.4F) {
        ++all;
        right += mesh.scans[v] == scans ? 1 : 0;
      }
    }
    EXPECT_GT(all, 250) << "of 8 x 48 samples, at " << middle_mm;
    EXPECT_GT(right, 0.95 * all) << "at " << middle_mm << ": " << scans;
  }
}

}  // namespace
}  // namespace dubsar
