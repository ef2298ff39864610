// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/mesh_score.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "core/parallel.h"
#include "triangulation/mesh_check.h"

namespace dubsar::bench {

using Eigen::Vector3f;

namespace {

constexpr double kNearEdgeMm = 0.2;

}  // namespace

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double rms(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) {
    squares += v * v;
  }
  return values.empty() ? 0 : std::sqrt(squares / static_cast<double>(values.size()));
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) {
    sum += v;
  }
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

std::vector<double> distances_mm(const std::vector<Vector3f>& points, const MeshQuery& to, double most_mm) {
  std::vector<double> d(points.size());
  parallel_for_each_index(d.size(), [&](std::size_t i) {
    const auto hit = to.closest(points[i], static_cast<float>(most_mm));
    d[i] = hit ? hit->distance_mm : most_mm;
  });
  return d;
}

std::vector<double> chosen(const std::vector<double>& values, const std::vector<std::uint8_t>& of) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (of[i] != 0) {
      out.push_back(values[i]);
    }
  }
  return out;
}

double share_within(const std::vector<double>& d, double mm) {
  return d.empty()
             ? 1.0
             : static_cast<double>(std::count_if(d.begin(), d.end(), [&](double v) { return v <= mm; })) /
                   static_cast<double>(d.size());
}

std::vector<std::uint8_t> near_wedge_edge(const sim::SimTablet& truth, const std::vector<Vector3f>& points) {
  // Such lines run where the true surface turns sharply within a wedge.
  const std::vector<Vector3f> normals = vertex_normals(truth.mesh);
  std::vector<std::uint8_t> edge(truth.mesh.positions.size(), 0);
  for (const auto& f : truth.mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = f[static_cast<std::size_t>(k)];
      const std::uint32_t b = f[static_cast<std::size_t>((k + 1) % 3)];
      if ((truth.wedge_of[a] >= 0 || truth.wedge_of[b] >= 0) && normals[a].dot(normals[b]) < 0.94F) {
        edge[a] = edge[b] = 1;
      }
    }
  }
  std::vector<std::uint8_t> out(points.size(), 0);
  Mesh edges;
  for (const auto& f : truth.mesh.faces) {
    if (edge[f[0]] + edge[f[1]] + edge[f[2]] >= 2) {
      edges.faces.push_back(f);
    }
  }
  edges.positions = truth.mesh.positions;
  if (edges.faces.empty()) {
    return out;
  }
  const MeshQuery at_edges(edges);
  parallel_for_each_index(points.size(), [&](std::size_t i) {
    out[i] = at_edges.closest(points[i], static_cast<float>(kNearEdgeMm)) ? 1 : 0;
  });
  return out;
}

void print_topology(const Mesh& mesh) {
  const MeshReport r = check_mesh(mesh);
  std::printf(
      "  %zu vertices, %zu faces; non-manifold edges %zu, vertices %zu; inconsistent faces %zu, degenerate "
      "%zu, duplicate %zu; self-intersections %zu; components %zu; %zu loops, boundary %.1f mm, longest %.2f "
      "mm; below 10 degrees "
      "%.3f %%\n",
      r.vertices, r.faces, r.non_manifold_edges, r.non_manifold_vertices, r.inconsistent_faces,
      r.degenerate_faces, r.duplicate_faces, r.self_intersections, r.components, r.boundary_loops,
      r.boundary_length_mm, r.longest_boundary_loop_mm, 100 * r.thin_share);
}

}  // namespace dubsar::bench
