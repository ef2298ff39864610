// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What wedges say of their errors where scans lay few samples across them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/wedges.h"
#include "core/mesh_query.h"
#include "core/order_statistics.h"
#include "core/units.h"
#include "sim/scanner.h"
#include "sim/tablet.h"
#include "tests/triangulation/support/evenly_spread.h"
#include "tests/triangulation/support/scans.h"
#include "triangulation/stitcher.h"

namespace dubsar {
namespace {

sim::SimTablet written_tablet() {
  sim::TabletOptions options;
  options.seed = 5;
  options.size_mm = {20, 16, 9};
  options.spacing_mm = 0.03;  // clay as coarse as the scans has chamfers for edges
  options.damage = sim::DamageOptions::none();
  JobContext job;
  return sim::make_tablet(options, job).value();
}

/// Scanned at µ 0.1 mm with the noise of a real scanner, and stitched where the scans truly lay.
Mesh coarsely_scanned(const sim::SimTablet& tablet) {
  const MeshQuery query(tablet.mesh);
  sim::Scene scene;
  scene.tablet = &tablet;
  scene.query = &query;
  sim::ScannerOptions options;
  options.spacing_mm = 0.1;
  const sim::TriangulationScanner scanner(options);
  JobContext job;
  test::ScanSet set;
  constexpr int kScans = 14;
  for (int k = 0; k < kScans; ++k) {
    const RigidTransform pose = test::tablet_from_scanner(k, kScans);
    set.add(scanner.scan_grid(scene, pose, static_cast<std::uint64_t>(k), job).value(), pose);
  }
  return stitch(set.placed, {}, job).value();
}

std::vector<Wedge> wedges_of(const Mesh& mesh) {
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(mesh);
  const SurfaceFields fields = compute_surface_fields(mesh, graph, {}, job).value();
  return find_wedges(mesh, graph, fields, {}, job).value().wedges;
}

TEST(CoarseScans, ErrorsLieWithinTheirSigmasAndOpeningsAreHardlyTooWide) {
  const sim::SimTablet tablet = written_tablet();
  std::vector<double> point_sigmas;
  int points = 0, points_within = 0, edges = 0, edges_within = 0, openings_within = 0;
  std::vector<double> openings_off_deg;
  for (const Wedge& found : wedges_of(coarsely_scanned(tablet))) {
    const auto is_near = [&](const Wedge& truth) {
      return truth.intact >= 0.6 && (truth.depth_point_mm - found.depth_point_mm).norm() < 0.3;
    };
    const auto truth = std::ranges::find_if(tablet.wedges, is_near);
    if (truth == tablet.wedges.end()) {
      continue;
    }
    ++points;
    point_sigmas.push_back((truth->depth_point_mm - found.depth_point_mm).norm() /
                           found.sigma.depth_point_mm);
    points_within +=
        (truth->depth_point_mm - found.depth_point_mm).norm() < 2 * found.sigma.depth_point_mm ? 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d along = (found.exit_points_mm[k] - found.depth_point_mm).normalized();
      double off = kPi;
      double true_opening_rad = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        const Eigen::Vector3d true_along = (truth->exit_points_mm[j] - truth->depth_point_mm).normalized();
        const double angle = std::atan2(along.cross(true_along).norm(), along.dot(true_along));
        true_opening_rad = angle < off ? truth->opening_angles_rad[j] : true_opening_rad;
        off = std::min(off, angle);
      }
      const double opening_off = found.opening_angles_rad[k] - true_opening_rad;
      openings_off_deg.push_back(deg_from_rad(opening_off));
      openings_within += std::abs(opening_off) < 2 * found.sigma.opening_rad[k] ? 1 : 0;
      ++edges;
      edges_within += off < 2 * found.sigma.edge_rad[k] ? 1 : 0;
    }
  }
  ASSERT_GT(points, 100);
  EXPECT_GT(median_of(point_sigmas), 0.4) << "they are not too large either";
  EXPECT_GT(points_within, 0.9 * points) << "of " << points;
  EXPECT_GT(edges_within, 0.9 * edges) << "of " << edges;
  EXPECT_GT(openings_within, 0.9 * edges) << "of " << edges;
  EXPECT_LT(std::abs(median_of(openings_off_deg)), 1.3) << "of one sign";
}

}  // namespace
}  // namespace dubsar
