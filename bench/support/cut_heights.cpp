// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/cut_heights.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "analysis/vertex_graph.h"
#include "bench/support/statistics.h"
#include "core/parallel.h"

namespace dubsar::bench {

namespace {

constexpr std::array<float, 8> kBounds = {0, 0.5F, 1, 1.5F, 2, 3, 5, 8};

struct Part {
  Mesh mesh;
  std::vector<std::uint32_t> whole;  ///< [V] the vertex of the mesh that it was cut from
};

Part cut(const Mesh& mesh, std::string_view what) {
  Part part;
  std::vector<std::int64_t> now(mesh.positions.size(), -1);
  for (const auto& face : mesh.faces) {
    const auto& a = mesh.positions[face[0]];
    const auto& b = mesh.positions[face[1]];
    const auto& c = mesh.positions[face[2]];
    // Impressions must not decide what belongs to the side.
    const Eigen::Vector3f n = (mesh.normals[face[0]] + mesh.normals[face[1]] + mesh.normals[face[2]]) / 3;
    const bool keep = what == "half" ? (a + b + c).x() < 0 : (a + b + c).z() > 0 && n.z() > 0.2F;
    if (!keep) {
      continue;
    }
    std::array<std::uint32_t, 3> face_now{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (now[face[k]] < 0) {
        now[face[k]] = static_cast<std::int64_t>(part.whole.size());
        part.whole.push_back(face[k]);
        part.mesh.positions.push_back(mesh.positions[face[k]]);
      }
      face_now[k] = static_cast<std::uint32_t>(now[face[k]]);
    }
    part.mesh.faces.push_back(face_now);
  }
  return part;
}

std::vector<Eigen::Vector3f> border_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(face[k], face[(k + 1) % 3]);
      ++edges[{low, high}];
    }
  }
  std::vector<Eigen::Vector3f> border;
  for (const auto& [edge, count] : edges) {
    if (count == 1) {
      border.push_back(0.5F * (mesh.positions[edge.first] + mesh.positions[edge.second]));
    }
  }
  return border;
}

}  // namespace

void print_cut_heights(const Mesh& mesh, const SurfaceFields& whole, std::string_view part_name,
                       const SurfaceFieldOptions& options, const JobContext& job) {
  const Part part = cut(mesh, part_name);
  const std::vector<Eigen::Vector3f> border = border_of(part.mesh);
  const VertexGraph graph = make_vertex_graph(part.mesh);
  const auto fields = compute_surface_fields(part.mesh, graph, options, job);
  if (!fields) {
    std::fprintf(stderr, "%s\n", fields.error().line().c_str());
    std::exit(2);
  }
  std::vector<float> away(part.whole.size());
  parallel_for_each_index(away.size(), [&](std::size_t i) {
    float nearest = std::numeric_limits<float>::max();
    for (const Eigen::Vector3f& p : border) {
      nearest = std::min(nearest, (p - part.mesh.positions[i]).squaredNorm());
    }
    away[i] = std::sqrt(nearest);
  });
  for (std::size_t k = 0; k < kBounds.size(); ++k) {
    std::vector<double> off;
    for (std::size_t i = 0; i < away.size(); ++i) {
      if (away[i] >= kBounds[k] && (k + 1 == kBounds.size() || away[i] < kBounds[k + 1])) {
        off.push_back(std::abs(fields->height_mm[i] - whole.height_mm[part.whole[i]]));
      }
    }
    std::printf("%s, %.1f mm from the border and more: height off by %.0f um (median), %.0f (95 %%), %zu\n",
                std::string(part_name).c_str(), kBounds[k], 1000 * quantile(off, 0.5),
                1000 * quantile(off, 0.95), off.size());
  }
}

}  // namespace dubsar::bench
