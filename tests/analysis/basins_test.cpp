// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/basins.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/analysis/support/pits.h"

namespace dubsar {
namespace {

/// Two round pits 4 mm apart, their saddle well below the rim, with grain on it.
float two_pits(double x, double y, double grain_mm) {
  const double left = std::hypot(x + 2.0, y) - 2.6;
  const double right = std::hypot(x - 2.0, y) - 2.6;
  const double grain = grain_mm * std::sin(31.0 * x) * std::sin(29.0 * y);
  return static_cast<float>(std::min({left, right, 0.0}) + grain);
}

struct Field {
  Mesh mesh;
  VertexGraph graph;
  std::vector<float> height;
  std::vector<std::uint8_t> free_surface;
  explicit Field(double grain_mm)
      : mesh(pits::sheet(12, 0.1, [&](double x, double y) { return two_pits(x, y, grain_mm); })),
        graph(make_vertex_graph(mesh)) {
    for (const Eigen::Vector3f& p : mesh.positions) {
      height.push_back(p.z());
      free_surface.push_back(p.z() > -0.1F ? 1 : 0);
    }
  }
  [[nodiscard]] std::int32_t label_at(const Basins& basins, float x, float y) const {
    std::size_t best = 0;
    for (std::size_t v = 0; v < height.size(); ++v) {
      const auto away = [&](std::size_t i) {
        return (mesh.positions[i].head<2>() - Eigen::Vector2f(x, y)).norm();
      };
      best = away(v) < away(best) ? v : best;
    }
    return basins.label[best];
  }
};

TEST(Basins, TwoPitsAreTwoBasinsWithABorderBetween) {
  const Field field(0.0);
  const Basins basins = find_basins(field.graph, field.height, field.free_surface, {});
  ASSERT_EQ(basins.count(), 2U);
  EXPECT_NE(field.label_at(basins, -2, 0), field.label_at(basins, 2, 0));
  EXPECT_EQ(field.label_at(basins, 0, 0), kBasinBorder);
  EXPECT_EQ(field.label_at(basins, 5.5, 5.5), kFreeSurfaceLabel);
  // The trap: a basin grows over all of its pit, not over its first vertex alone.
  EXPECT_GT(basins.vertices_of(0).size(), 1500U);
  EXPECT_GT(basins.vertices_of(1).size(), 1500U);
}

TEST(Basins, ListTheirVerticesInRisingHeight) {
  const Field field(0.02);
  const Basins basins = find_basins(field.graph, field.height, field.free_surface, {});
  ASSERT_GT(basins.count(), 0U);
  for (std::size_t b = 0; b < basins.count(); ++b) {
    const auto vertices = basins.vertices_of(b);
    ASSERT_FALSE(vertices.empty());
    EXPECT_EQ(vertices.front(), basins.lowest[b]);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      EXPECT_EQ(basins.label[vertices[i]], static_cast<std::int32_t>(b));
      EXPECT_TRUE(i == 0 || field.height[vertices[i - 1]] <= field.height[vertices[i]]);
    }
  }
}

TEST(Basins, GrainIsFloodedAndTheClassicalWatershedOverSegments) {
  const Field field(0.06);
  BasinOptions options;
  options.min_depth_mm = 0.25F;
  const Basins modified = find_basins(field.graph, field.height, field.free_surface, options);
  options.classical = true;
  const Basins classical = find_basins(field.graph, field.height, field.free_surface, options);
  EXPECT_EQ(modified.count(), 2U);
  EXPECT_GT(classical.count(), 20U);
}

TEST(Basins, SecondRingJoinsPitsThatAreTooNear) {
  // Two lowest vertices two edges apart: the second one sees the first in its 2-ring.
  const Mesh mesh = pits::sheet(1.0, 0.1, [](double, double) { return 0.0; });
  const VertexGraph graph = make_vertex_graph(mesh);
  std::vector<float> height;
  for (const Eigen::Vector3f& p : mesh.positions) {
    height.push_back(-0.5F + 0.1F * p.head<2>().norm());
  }
  const std::size_t middle = mesh.positions.size() / 2;
  height[middle] = -1.0F;
  height[middle + 2] = -0.9F;
  const std::vector<std::uint8_t> free_surface(height.size(), 0);
  BasinOptions options;
  options.min_vertices = 0;
  options.min_depth_mm = 0;
  EXPECT_EQ(find_basins(graph, height, free_surface, options).count(), 1U);
  options.classical = true;
  EXPECT_GE(find_basins(graph, height, free_surface, options).count(), 2U);
}

TEST(Basins, NothingToFloodAndHeightsThatAreNone) {
  Field field(0.0);
  std::ranges::fill(field.free_surface, std::uint8_t{1});
  EXPECT_EQ(find_basins(field.graph, field.height, field.free_surface, {}).count(), 0U);
  std::ranges::fill(field.free_surface, std::uint8_t{0});
  std::ranges::fill(field.height, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(find_basins(field.graph, field.height, field.free_surface, {}).count(), 0U);
  EXPECT_EQ(find_basins({{0}, {}, {0}, {}}, {}, {}, {}).count(), 0U);
}

}  // namespace
}  // namespace dubsar
