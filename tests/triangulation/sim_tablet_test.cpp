// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cmath>

#include "core/grid_lookup.h"
#include "core/mesh_query.h"
#include "sim/scanner.h"
#include "tests/triangulation/support/evenly_spread.h"
#include "tests/triangulation/support/scans.h"
#include "tests/triangulation/support/simulated_tablet.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

TEST(SimTablet, CoversWhatWasSampledAndAveragesTheNoise) {
  JobContext job;
  const test::SimulatedTablet tablet({16, 14, 8});
  sim::ScannerOptions scanner_options;
  scanner_options.spacing_mm = 0.1;
  const sim::TriangulationScanner scanner(scanner_options);
  test::ScanSet set;
  constexpr int kScans = 16;
  for (int k = 0; k < kScans; ++k) {
    const RigidTransform pose = test::tablet_from_scanner(k, kScans);
    auto grid = scanner.scan_grid(tablet.scene(), pose, static_cast<std::uint64_t>(k), job);
    ASSERT_TRUE(grid.has_value());
    set.add(std::move(*grid), pose);
  }
  const Result<Mesh> mesh = stitch(set.placed, {}, job);
  ASSERT_TRUE(mesh.has_value());
  const MeshReport report = check_mesh(*mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_GT(static_cast<double>(report.largest_component), 0.99 * static_cast<double>(report.faces));

  double sum2 = 0;
  for (const Eigen::Vector3f& p : mesh->positions) {
    const auto closest = tablet.truth().closest(p, 1.0F);
    ASSERT_TRUE(closest.has_value());
    sum2 += closest->distance_mm * closest->distance_mm;
  }
  // A single sample is off by 0.02 mm and more.
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(mesh->positions.size())), 0.018);

  // Clay that some scan sampled well must lie under the mesh.
  std::vector<std::uint8_t> seen(tablet.mesh().positions.size(), 0);
  for (std::size_t k = 0; k < set.placed.size(); ++k) {
    std::vector<std::uint8_t> keep(set.grids[k].size());
    for (std::size_t i = 0; i < keep.size(); ++i) {
      keep[i] = is_unflagged(set.flags[k][i]) ? 1 : 0;
    }
    const GridLookup lookup(set.grids[k], keep);
    const RigidTransform scanner_from_tablet = set.placed[k].model_from_scanner.inverse();
    for (std::size_t v = 0; v < seen.size(); ++v) {
      const Eigen::Vector3f p =
          (scanner_from_tablet * tablet.mesh().positions[v].cast<double>()).cast<float>();
      seen[v] |= lookup.nearest(p, 0.1F) >= 0 ? 1 : 0;
    }
  }
  const MeshQuery stitched(*mesh);
  std::size_t sampled = 0;
  std::size_t covered = 0;
  for (std::size_t v = 0; v < seen.size(); ++v) {
    if (seen[v] != 0) {
      ++sampled;
      covered += stitched.closest(tablet.mesh().positions[v], 0.1F).has_value() ? 1 : 0;
    }
  }
  EXPECT_GT(static_cast<double>(sampled), 0.95 * static_cast<double>(seen.size()));
  EXPECT_GT(static_cast<double>(covered), 0.99 * static_cast<double>(sampled));
}

}  // namespace
}  // namespace dubsar
