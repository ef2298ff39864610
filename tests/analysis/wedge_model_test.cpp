// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Faces, inner edges and depth point of a single pit whose shape is known.

#include <gtest/gtest.h>

#include "analysis/inner_edges.h"
#include "analysis/normal_clusters.h"
#include "analysis/wedge_faces.h"
#include "core/random.h"
#include "core/units.h"
#include "tests/analysis/support/pits.h"

namespace dubsar {
namespace {

using pits::Pit;

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

/// Worst angles of normals and edges against the pit's, by the best cyclic order; and the depth point's
/// error.
struct Error {
  double normal_deg = 0, edge_deg = 0, tip_mm = 0;
};

Error error_of(const Pit& pit, const WedgePatch& patch, const WedgeFaces& faces, const InnerEdges& edges) {
  Error best{1e9, 1e9, (patch.to_model(edges.depth_point) - pit.tip).norm()};
  for (std::size_t shift = 0; shift < 3; ++shift) {
    double normal = 0;
    double edge = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t own = (k + shift) % 3;
      normal =
          std::max(normal, degrees_between(patch.model_from_patch * faces.plane[own].normal, pit.normal(k)));
      edge = std::max(
          edge, degrees_between(patch.model_from_patch * edges.edge[own].direction, pit.exits[k] - pit.tip));
    }
    if (normal < best.normal_deg) {
      best.normal_deg = normal;
      best.edge_deg = edge;
    }
  }
  return best;
}

TEST(NormalClusters, FindsThreeDirectionsInNoise) {
  const Pit pit;
  Random random(3);
  std::vector<Eigen::Vector3f> normals;
  for (int i = 0; i < 600; ++i) {
    const Eigen::Vector3d shake = random.normal3();
    normals.push_back(
        (pit.normal(static_cast<std::size_t>(i % 3)) + 0.15 * shake).normalized().cast<float>());
  }
  const std::vector<float> weights(normals.size(), 1.0F);
  const auto triples = cluster_normals(normals, weights);
  ASSERT_FALSE(triples.empty());
  for (const Eigen::Vector3d& centre : triples.front()) {
    EXPECT_LT(std::min({degrees_between(centre, pit.normal(0)), degrees_between(centre, pit.normal(1)),
                        degrees_between(centre, pit.normal(2))}),
              3.0);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(std::ranges::any_of(
        triples.front(),
        [&](const Eigen::Vector3d& centre) { return degrees_between(centre, pit.normal(k)) < 3.0; }))
        << "one for each, not thrice the same: " << k;
  }
}

TEST(WedgeModel, MeasuresAnIdealPit) {
  const Pit pit;
  const pits::Scene scene(pits::sheet(6, 0.1, [&](double x, double y) { return pit.floor(x, y); }));
  const WedgePatch patch = scene.patch(0.03F);
  const auto faces = find_faces(patch, {});
  ASSERT_TRUE(faces) << faces.error();
  const InnerEdges edges = find_inner_edges(patch, *faces);
  const Error error = error_of(pit, patch, *faces, edges);
  EXPECT_LT(error.normal_deg, 1.0);
  EXPECT_LT(error.edge_deg, 1.5);
  EXPECT_LT(error.tip_mm, 0.02);
}

TEST(WedgeModel, MeasuresANoisyPit) {
  const Pit pit;
  Random random(5);
  const pits::Scene scene(
      pits::sheet(6, 0.06, [&](double x, double y) { return pit.floor(x, y) + 0.01 * random.normal(); }));
  const WedgePatch patch = scene.patch(0.05F);
  const auto faces = find_faces(patch, {});
  ASSERT_TRUE(faces) << faces.error();
  const Error error = error_of(pit, patch, *faces, find_inner_edges(patch, *faces));
  EXPECT_LT(error.normal_deg, 3.0);
  EXPECT_LT(error.edge_deg, 3.0);
  EXPECT_LT(error.tip_mm, 0.05);
}

TEST(WedgeModel, FindsTheDepthPointUnderTheDirt) {
  const Pit pit;
  const pits::Scene scene(
      pits::sheet(6, 0.08, [&](double x, double y) { return std::max(pit.floor(x, y), -0.3 + 0.01 * x); }));
  const WedgePatch patch = scene.patch(0.03F);
  const auto faces = find_faces(patch, {});
  ASSERT_TRUE(faces) << faces.error();
  const Error error = error_of(pit, patch, *faces, find_inner_edges(patch, *faces));
  EXPECT_LT(error.tip_mm, 0.06);
  EXPECT_LT(error.edge_deg, 4.0);
}

TEST(WedgeModel, ABentEdgeIsACurveAndAStraightOneIsNot) {
  const Pit pit;
  const auto bent = [&](double x, double y) { return pit.floor(x, y - 0.08 * x * x); };
  const pits::Scene straight_scene(pits::sheet(6, 0.05, [&](double x, double y) { return pit.floor(x, y); }));
  const pits::Scene bent_scene(pits::sheet(6, 0.05, bent));
  const auto longest_bow = [](const pits::Scene& scene) {
    const WedgePatch patch = scene.patch(0.03F);
    const auto faces = find_faces(patch, {});
    EXPECT_TRUE(faces);
    double bow = 0;
    for (const InnerEdge& edge : find_inner_edges(patch, *faces).edge) {
      bow = edge.extent_mm > 0.9 ? edge.bow_mm : bow;
    }
    return bow;
  };
  EXPECT_EQ(longest_bow(straight_scene), 0.0);
  EXPECT_GT(longest_bow(bent_scene), 0.008);
}

TEST(WedgeModel, ARoofAndAPlaneAreNoPits) {
  const pits::Scene groove(
      pits::sheet(6, 0.1, [](double x, double) { return std::min(0.0, std::abs(x) - 0.5); }));
  EXPECT_FALSE(find_faces(groove.patch(0.03F), {}));
  const pits::Scene flat(pits::sheet(6, 0.1, [](double, double) { return -0.2; }));
  EXPECT_FALSE(find_faces(flat.patch(0.03F), {}));
}

}  // namespace
}  // namespace dubsar
