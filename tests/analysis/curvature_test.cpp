// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/curvature.h"

#include <gtest/gtest.h>

#include "analysis/smooth_curvature.h"
#include "core/random.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

struct Analysed {
  explicit Analysed(Mesh m)
      : mesh(std::move(m)),
        graph(make_vertex_graph(mesh)),
        geometry(make_vertex_geometry(mesh, graph)),
        curvature(vertex_curvature(mesh, graph, geometry)) {}
  Mesh mesh;
  VertexGraph graph;
  VertexGeometry geometry;
  Curvature curvature;
};

TEST(Curvature, OfASphere) {
  const Analysed sphere(shapes::sphere(10, 5));
  for (std::size_t v = 0; v < sphere.mesh.positions.size(); ++v) {
    ASSERT_NEAR(sphere.curvature.mean_per_mm[v], 0.1, 0.003) << v;
    ASSERT_NEAR(sphere.curvature.gaussian_per_mm2[v], 0.01, 0.001) << v;
  }
  EXPECT_NEAR(sphere.geometry.total_area_mm2, 4 * kPi * 100, 2);
}

TEST(Curvature, OfTheInsideOfASphereIsStillThatOfTheClay) {
  // Faces that run the wrong way round: the normals are turned outwards, and a ball is convex.
  Mesh mesh = shapes::sphere(10, 4);
  for (auto& f : mesh.faces) {
    std::swap(f[0], f[1]);
  }
  const Analysed sphere(std::move(mesh));
  EXPECT_TRUE(sphere.geometry.turned);
  EXPECT_NEAR(sphere.curvature.mean_per_mm[100], 0.1, 0.005);
}

TEST(Curvature, OfAnEllipsoidAtItsPoles) {
  // At the pole (0,0,c) of x²/a² + y²/b² + z²/c² = 1 the principal curvatures are c/a² and c/b².
  const Analysed ellipsoid(shapes::scaled(shapes::unit_sphere(6), {10, 6, 4}));
  const float k1 = 4.0F / 36;
  const float k2 = 4.0F / 100;
  EXPECT_NEAR(ellipsoid.curvature.mean_per_mm[4], (k1 + k2) / 2, 0.002);
  EXPECT_NEAR(ellipsoid.curvature.gaussian_per_mm2[4], k1 * k2, 0.0004);
  const PrincipalCurvature principal =
      principal_curvature(ellipsoid.mesh, ellipsoid.graph, ellipsoid.geometry, ellipsoid.curvature, 4);
  EXPECT_NEAR(principal.maximum_per_mm, k1, 0.01);
  EXPECT_NEAR(principal.minimum_per_mm, k2, 0.01);
  EXPECT_GT(std::abs(principal.maximum_direction.y()), 0.99F);
  EXPECT_GT(std::abs(principal.minimum_direction.x()), 0.99F);
}

TEST(Curvature, OfAGrooveIsNegative) {
  const Analysed groove(shapes::sheet(5, 100, [](float x, float) { return 0.1F * x * x; }));
  EXPECT_NEAR(groove.curvature.mean_per_mm[50 * 101 + 50], -0.1, 0.002);
  EXPECT_NEAR(groove.curvature.gaussian_per_mm2[50 * 101 + 50], 0, 1e-4);
}

TEST(Curvature, OfAPlaneIsNoneUpToItsOpenBorder) {
  const Analysed plane(shapes::sheet(5, 20, [](float, float) { return 1.0F; }));
  for (std::size_t v = 0; v < plane.mesh.positions.size(); ++v) {
    ASSERT_NEAR(plane.curvature.mean_per_mm[v], 0, 1e-4) << v;
    ASSERT_NEAR(plane.curvature.gaussian_per_mm2[v], 0, 1e-3) << v;
  }
}

TEST(Curvature, FaultyFacesLeaveItFinite) {
  Mesh mesh = shapes::sphere(10, 4);
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    auto& f = mesh.faces[random.below(mesh.faces.size())];
    std::swap(f[0], f[1]);
    mesh.faces.push_back(mesh.faces[random.below(mesh.faces.size())]);
  }
  mesh.positions.push_back(mesh.positions[5]);
  mesh.faces.push_back({5, 6, static_cast<std::uint32_t>(mesh.positions.size() - 1)});  // no area
  mesh.positions.emplace_back(50, 50, 50);                                              // no face
  const Analysed sphere(std::move(mesh));
  std::size_t near = 0;
  for (std::size_t v = 0; v < sphere.mesh.positions.size(); ++v) {
    ASSERT_TRUE(std::isfinite(sphere.curvature.mean_per_mm[v])) << v;
    ASSERT_TRUE(std::isfinite(sphere.curvature.gaussian_per_mm2[v])) << v;
    near += std::abs(sphere.curvature.mean_per_mm[v] - 0.1F) < 0.01F ? 1U : 0U;
    ASSERT_GE(sphere.geometry.normal[v].dot(sphere.mesh.positions[v].normalized()),
              sphere.geometry.area_mm2[v] > 0 ? 0.9F : 0.0F)
        << v;
  }
  EXPECT_GT(near, sphere.mesh.positions.size() * 98 / 100);
}

TEST(SmoothCurvature, SeesTheShapeThroughNoiseThatDrownsTheRing) {
  Mesh mesh = shapes::sphere(10, 7);  // 0.1 mm
  Random random(1);
  for (Eigen::Vector3f& p : mesh.positions) {
    p *= 1.0F + 0.002F * static_cast<float>(random.normal());  // 20 µm
  }
  const Analysed sphere(std::move(mesh));
  const std::vector<float> smooth = smooth_mean_curvature(sphere.mesh, sphere.geometry, 0.5F);
  double ring = 0;
  double mean = 0;
  double spread = 0;
  for (std::size_t v = 0; v < smooth.size(); ++v) {
    ring += std::abs(sphere.curvature.mean_per_mm[v] - 0.1);
    mean += smooth[v];
    spread += (smooth[v] - 0.1) * (smooth[v] - 0.1);
  }
  const auto count = static_cast<double>(smooth.size());
  EXPECT_GT(ring / count, 1.0);
  EXPECT_NEAR(mean / count, 0.1, 0.01);
  EXPECT_LT(std::sqrt(spread / count), 0.1);
  EXPECT_NEAR(sphere.geometry.roughness_mm, 0.0216, 0.002);
}

}  // namespace
}  // namespace dubsar
