// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <Eigen/Geometry>

#include <algorithm>

#include "analysis/surface_fields.h"
#include "core/random.h"
#include "core/units.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

HeightSurface surface_of(const Mesh& mesh, const ReconstructionOptions& options = {},
                         const std::vector<std::uint8_t>& free_surface = {}) {
  const JobContext job;
  const std::size_t count = mesh.positions.size();
  return reconstruct_surface(mesh, make_vertex_geometry(mesh, make_vertex_graph(mesh)),
                             free_surface.empty() ? std::vector<std::uint8_t>(count, 1) : free_surface,
                             std::vector<float>(count, 1.0F), options, job);
}

TEST(Height, OverASphereIsTheDistanceToIt) {
  constexpr float kRadius = 15;
  const HeightSurface surface = surface_of(shapes::sphere(kRadius, 7));
  ASSERT_FALSE(surface.mesh().faces.empty());
  for (const Eigen::Vector3f& direction : shapes::unit_sphere(3).positions) {
    for (const float height : {-3.5F, -1.0F, -0.1F, 0.0F, 0.5F, 1.5F}) {
      ASSERT_NEAR(surface.height_mm((kRadius + height) * direction), height, 0.03) << direction.transpose();
    }
    ASSERT_GT(surface.normal((kRadius - 1) * direction).dot(direction), 0.999F);
    const auto foot = surface.closest((kRadius - 2) * direction);
    ASSERT_TRUE(foot);
    ASSERT_NEAR(foot->norm(), kRadius, 0.03);
    const auto out = surface.crossing((kRadius - 2) * direction, direction, 5);
    ASSERT_TRUE(out);
    ASSERT_NEAR(out->norm(), kRadius, 0.03);
    ASSERT_FALSE(surface.crossing((kRadius - 2) * direction, direction, 1.5F));
  }
  // Closed, and its triangles look out.
  double volume = 0;
  for (const auto& f : surface.mesh().faces) {
    volume +=
        surface.mesh().positions[f[0]].cast<double>().dot(surface.mesh().positions[f[1]].cast<double>().cross(
            surface.mesh().positions[f[2]].cast<double>())) /
        6;
  }
  EXPECT_NEAR(volume / (4.0 / 3.0 * kPi * kRadius * kRadius * kRadius), 1.0, 0.005);
}

TEST(Height, OfASpheresOwnVerticesIsAFewMicrometres) {
  for (const float radius : {8.0F, 15.0F, 30.0F}) {
    const Mesh mesh = shapes::sphere(radius, 7);
    const HeightSurface surface = surface_of(mesh);
    double sum = 0;
    double squares = 0;
    for (const Eigen::Vector3f& p : mesh.positions) {
      const double height = surface.height_mm(p);
      sum += height;
      squares += height * height;
      ASSERT_LT(std::abs(height), 0.035) << p.transpose();
    }
    const auto count = static_cast<double>(mesh.positions.size());
    EXPECT_NEAR(sum / count, 0, 0.001) << radius;
    EXPECT_LT(std::sqrt(squares / count), 0.008) << radius;
  }
}

TEST(Height, IsMeasuredFromTheSurfaceThatIsShown) {
  const HeightSurface surface = surface_of(shapes::scaled(shapes::unit_sphere(7), {25, 18, 8}));
  ASSERT_FALSE(surface.mesh().positions.empty());
  for (const Eigen::Vector3f& p : surface.mesh().positions) {
    ASSERT_NEAR(surface.height_mm(p), 0, 0.001) << p.transpose();
  }
}

TEST(Height, OfAnEllipsoidsOwnVerticesIsNone) {
  const Mesh mesh = shapes::scaled(shapes::unit_sphere(7), {25, 18, 8});
  const HeightSurface surface = surface_of(mesh);
  float worst = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    worst = std::max(worst, std::abs(surface.height_mm(p)));
  }
  EXPECT_LT(worst, 0.06F);
}

TEST(Height, OfABoxIsNoneAwayFromItsEdges) {
  const Eigen::Vector3f half(20, 15, 8);
  const Mesh mesh = shapes::box(half, 120);
  const HeightSurface surface = surface_of(mesh);
  for (const Eigen::Vector3f& p : mesh.positions) {
    const Eigen::Vector3f inside = half - p.cwiseAbs();
    std::array<float, 3> sorted{inside.x(), inside.y(), inside.z()};
    std::sort(sorted.begin(), sorted.end());
    const float height = surface.height_mm(p);
    ASSERT_LT(std::abs(height), sorted[1] > 3.0F ? 0.03F : 0.5F) << p.transpose();
  }
}

TEST(Height, OfAnOpenSheetIsNone) {
  const Mesh mesh = shapes::sheet(15, 150, [](float x, float y) { return -0.01F * (x * x + y * y); });
  const HeightSurface surface = surface_of(mesh);
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (std::max(std::abs(p.x()), std::abs(p.y())) < 13) {
      ASSERT_NEAR(surface.height_mm(p), 0, 0.03) << p.transpose();
    }
  }
}

/// Impressions 0.5 mm deep and 2 mm wide every 2.4 mm: three quarters of the face are written on.
constexpr float kPitch = 2.4F;
constexpr float kDeep = 0.5F;
float dense_text(float x, float y) {
  const auto across = [](float v) { return std::abs(v - kPitch * std::round(v / kPitch)); };
  const float in = 1.0F - std::max(across(x), across(y));
  return std::max(std::abs(x), std::abs(y)) > 15.5F ? 0.0F : -kDeep * std::clamp(in, 0.0F, 1.0F);
}

/// Seed 000, Fig. 5: with uniform weights dense text pulls the surface down; with weights raised on the free
/// surface it does not.
TEST(Height, DenseTextDoesNotPullTheSurfaceDown) {
  const Mesh mesh = shapes::sheet(25, 500, dense_text);
  std::vector<std::uint8_t> free_surface;
  for (const Eigen::Vector3f& p : mesh.positions) {
    free_surface.push_back(p.z() > -0.02F ? 1 : 0);
  }
  ReconstructionOptions uniform;
  uniform.other_weight = 1;
  const HeightSurface weighted = surface_of(mesh, {}, free_surface);
  const HeightSurface pulled = surface_of(mesh, uniform, free_surface);
  double sum_weighted = 0;
  double sum_pulled = 0;
  int count = 0;
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j) {
      // Middle of an impression: its true depth is kDeep.
      const Eigen::Vector3f bottom(kPitch * static_cast<float>(i), kPitch * static_cast<float>(j), -kDeep);
      sum_weighted += -weighted.height_mm(bottom);
      sum_pulled += -pulled.height_mm(bottom);
      ++count;
    }
  }
  EXPECT_NEAR(sum_weighted / count, kDeep, 0.05);
  EXPECT_LT(sum_pulled / count, kDeep - 0.15);
}

TEST(SurfaceFields, FindTheImpressionsByThemselves) {
  const Mesh mesh = shapes::sheet(25, 500, dense_text);
  const JobContext job;
  StageTimes times;
  const auto fields = compute_surface_fields(mesh, make_vertex_graph(mesh), {}, job, &times);
  ASSERT_TRUE(fields);
  EXPECT_GE(times.size(), 6U);
  const auto at = [&](float x, float y) {
    return static_cast<std::size_t>(std::lround((y + 25) * 10)) * 501 +
           static_cast<std::size_t>(std::lround((x + 25) * 10));
  };
  EXPECT_EQ(fields->free_surface[at(20, 0)], 1);
  EXPECT_EQ(fields->free_surface[at(2.4F, 0)], 0);
  EXPECT_LT(fields->openness[at(2.4F, 2.4F)], 0.8F);
  // The upper ends of the slopes pass for free surface.
  EXPECT_NEAR(fields->height_mm[at(2.4F, 2.4F)], -kDeep, 0.08);
  EXPECT_NEAR(fields->height_mm[at(20, 0)], 0, 0.02);
  EXPECT_GT(fields->normal[at(20, 0)].z(), 0.999F);
}

TEST(SurfaceFields, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::sheet(12, 240, dense_text);
  const JobContext job;
  const VertexGraph graph = make_vertex_graph(mesh);
  const auto many = compute_surface_fields(mesh, graph, {}, job);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = compute_surface_fields(mesh, graph, {}, job);
  ASSERT_TRUE(many && single);
  EXPECT_TRUE(many->reliability == single->reliability);
  EXPECT_TRUE(many->mean_curvature_per_mm == single->mean_curvature_per_mm);
  EXPECT_TRUE(many->openness == single->openness);
  EXPECT_TRUE(many->free_surface == single->free_surface);
  EXPECT_TRUE(many->height_mm == single->height_mm);
  EXPECT_TRUE(many->surface.mesh().positions == single->surface.mesh().positions);
}

/// 1 % of the faces deleted, 1 % twice, 1 % flipped, and scraps about: the heights stay.
TEST(SurfaceFields, HoldOnAFaultyMesh) {
  const Mesh sound = shapes::sheet(15, 300, dense_text);
  Mesh faulty = sound;
  Random random(5);
  for (std::size_t i = 0; i < sound.faces.size() / 100; ++i) {
    faulty.faces.erase(faulty.faces.begin() + static_cast<std::ptrdiff_t>(random.below(faulty.faces.size())));
    faulty.faces.push_back(faulty.faces[random.below(faulty.faces.size())]);
    auto& f = faulty.faces[random.below(faulty.faces.size())];
    std::swap(f[0], f[1]);
  }
  for (int i = 0; i < 20; ++i) {
    const auto first = static_cast<std::uint32_t>(faulty.positions.size());
    const Eigen::Vector3f at{static_cast<float>(random.uniform(-15, 15)),
                             static_cast<float>(random.uniform(-15, 15)), 1.0F};
    faulty.positions.insert(faulty.positions.end(),
                            {at, at + Eigen::Vector3f(0.2F, 0, 0), at + Eigen::Vector3f(0, 0.2F, 0)});
    faulty.faces.push_back({first, first + 1, first + 2});
  }
  faulty.faces.push_back({1, 2, 4000000000U});
  const JobContext job;
  const auto a = compute_surface_fields(sound, make_vertex_graph(sound), {}, job);
  const auto b = compute_surface_fields(faulty, make_vertex_graph(faulty), {}, job);
  ASSERT_TRUE(a && b);
  std::size_t apart = 0;
  for (std::size_t v = 0; v < sound.positions.size(); ++v) {
    // Where a sheet ends, how its surface would go on is anybody's guess.
    if (sound.positions[v].head<2>().cwiseAbs().maxCoeff() < 12) {
      apart += std::abs(a->height_mm[v] - b->height_mm[v]) > 0.05F ? 1U : 0U;
    }
  }
  EXPECT_LT(apart, sound.positions.size() / 100);
}

TEST(SurfaceFields, AScrapAMetreAwayChangesNothing) {
  const Mesh sound = shapes::sphere(12, 6);
  Mesh strayed = sound;
  const auto first = static_cast<std::uint32_t>(strayed.positions.size());
  strayed.positions.insert(strayed.positions.end(), {{1000, 0, 0}, {1000.2F, 0, 0}, {1000, 0.2F, 0}});
  strayed.faces.push_back({first, first + 1, first + 2});
  const JobContext job;
  const auto a = compute_surface_fields(sound, make_vertex_graph(sound), {}, job);
  const auto b = compute_surface_fields(strayed, make_vertex_graph(strayed), {}, job);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->surface.cell_mm(), b->surface.cell_mm(), 0.001);
  for (std::size_t v = 0; v < sound.positions.size(); ++v) {
    ASSERT_NEAR(a->height_mm[v], b->height_mm[v], 0.03) << v;  // another place in the grid
    ASSERT_NEAR(a->openness[v], b->openness[v], 0.1) << v;
  }
  EXPECT_TRUE(std::isfinite(b->height_mm[first]));
}

TEST(SurfaceFields, AMeshOfTenFacesIsNoTrouble) {
  Mesh mesh = shapes::sphere(10, 0);
  mesh.faces.push_back({0, 2, 3});
  mesh.faces.push_back({0, 1, 4});
  const JobContext job;
  const auto fields = compute_surface_fields(mesh, make_vertex_graph(mesh), {}, job);
  ASSERT_TRUE(fields);
  for (const float h : fields->height_mm) {
    EXPECT_TRUE(std::isfinite(h));
  }
}

TEST(SurfaceFields, AMeshWithoutFacesIsRefused) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2}};  // no area
  const JobContext job;
  const auto fields = compute_surface_fields(mesh, make_vertex_graph(mesh), {}, job);
  ASSERT_FALSE(fields);
  EXPECT_EQ(fields.error().kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace dubsar
