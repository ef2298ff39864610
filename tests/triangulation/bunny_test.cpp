// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cmath>

#include "core/mesh_query.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

TEST(Bunny, StitchesTheRealScans) {
  const test::ScanSet set = test::bunny();
  const std::vector<Eigen::Vector3f> published = test::bunny_zipper();
  if (set.placed.size() != 10 || published.empty()) {
    GTEST_SKIP() << "the Stanford bunny is not at " << test::real_data();
  }
  JobContext job;
  const Result<Mesh> mesh = stitch(set.placed, {}, job);
  ASSERT_TRUE(mesh.has_value()) << mesh.error().line();
  const MeshReport report = check_mesh(*mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.components, 1U);
  EXPECT_LT(report.thin_share, 0.01);

  const MeshQuery query(*mesh);
  std::size_t within = 0;
  for (const Eigen::Vector3f& p : published) {
    within += query.closest(p, 0.4F).has_value() ? 1 : 0;
  }
  EXPECT_GE(static_cast<double>(within), 0.99 * static_cast<double>(published.size()));

  double sum = 0;
  double sum2 = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < set.placed.size(); ++k) {
    const RangeGrid& grid = set.grids[k];
    for (std::size_t i = k; i < grid.size(); i += 7) {
      if (grid.valid[i] == 0 || !is_unflagged(set.flags[k][i])) {
        continue;
      }
      const Eigen::Vector3f p =
          (set.placed[k].model_from_scanner * grid.point(i).cast<double>()).cast<float>();
      const auto closest = query.closest(p, 5.0F);
      ASSERT_TRUE(closest.has_value());
      sum += closest->distance_mm;
      sum2 += closest->distance_mm * closest->distance_mm;
      ++count;
    }
  }
  EXPECT_LT(sum / static_cast<double>(count), 0.085);
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(count)), 0.115);
}

}  // namespace
}  // namespace dubsar
