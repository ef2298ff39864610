// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "analysis/vertex_graph.h"
#include "analysis/wedge_patch.h"
#include "core/mesh.h"

namespace dubsar::pits {

/// A square sheet over z = f(x, y), its middle at the origin.
inline Mesh sheet(double side_mm, double spacing_mm, const std::function<double(double, double)>& f) {
  const auto n = static_cast<std::uint32_t>(std::lround(side_mm / spacing_mm)) + 1;
  Mesh mesh;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double x = -0.5 * side_mm + spacing_mm * i;
      const double y = -0.5 * side_mm + spacing_mm * j;
      mesh.positions.push_back(Eigen::Vector3d(x, y, f(x, y)).cast<float>());
    }
  }
  for (std::uint32_t j = 0; j + 1 < n; ++j) {
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i;
      mesh.faces.push_back({a, a + 1, a + n + 1});
      mesh.faces.push_back({a, a + n + 1, a + n});
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

/// A tetrahedral pit: its depth point and the three places, counter-clockwise, where it comes out at z = 0.
struct Pit {
  Eigen::Vector3d tip{0.03, 0.02, -0.5};
  std::array<Eigen::Vector3d, 3> exits = {Eigen::Vector3d(2.0, 0.1, 0), Eigen::Vector3d(-0.35, 0.65, 0),
                                          Eigen::Vector3d(-0.3, -0.7, 0)};
  [[nodiscard]] Eigen::Vector3d normal(std::size_t k) const {
    return (exits[k] - tip).cross(exits[(k + 1) % 3] - tip).normalized();
  }
  [[nodiscard]] double floor(double x, double y) const {
    double z = -1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d n = normal(k);
      z = std::max(z, tip.z() - (n.x() * (x - tip.x()) + n.y() * (y - tip.y())) / n.z());
    }
    return std::min(z, 0.0);
  }
};

/// What a patch is cut from: the free surface is z = 0.
struct Scene {
  Mesh mesh;
  VertexGraph graph;
  std::vector<float> reliability, area, height;

  explicit Scene(Mesh made) : mesh(std::move(made)), graph(make_vertex_graph(mesh)) {
    reliability.assign(mesh.positions.size(), 1.0F);
    area.assign(mesh.positions.size(), 0.01F);
    for (const Eigen::Vector3f& p : mesh.positions) {
      height.push_back(p.z());
    }
  }
  /// All vertices more than `below_mm` under the free surface, as one patch.
  [[nodiscard]] WedgePatch patch(float below_mm) const {
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < height.size(); ++v) {
      if (height[v] < -below_mm) {
        vertices.push_back(v);
      }
    }
    std::ranges::stable_sort(vertices, {}, [&](std::uint32_t v) { return height[v]; });
    std::vector<std::int32_t> slot(height.size(), -1);
    return make_patch({&graph, mesh.faces, area, mesh.positions, mesh.normals, reliability, height, false},
                      vertices, Eigen::Vector3d::UnitZ(), &slot);
  }
};

}  // namespace dubsar::pits
