// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/units.h"
#include "triangulation/manifold.h"
#include "triangulation/self_intersections.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;

/// Smallest angle of the triangle; 0 when it has no area.
double smallest_angle_rad(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double area2 = (b - a).cross(c - a).norm();
  if (!(area2 > 0)) {
    return 0;
  }
  return std::min({std::atan2(area2, (b - a).dot(c - a)), std::atan2(area2, (c - b).dot(a - b)),
                   std::atan2(area2, (a - c).dot(b - c))});
}

/// How many fans the faces around a vertex form, joined across edges of exactly two opposite half-edges.
int fan_count(const std::vector<Triangle>& faces, const HalfEdges& edges, std::uint32_t v) {
  const auto outs = edges.from(v);
  int fans = 0;
  // Each fan that is open has one face whose incoming edge has no face beyond; closed fans are found by
  // walking from faces that no open fan reached.
  std::vector<std::uint8_t> seen(outs.size(), 0);
  const auto walk = [&](std::size_t at) {
    while (seen[at] == 0) {
      seen[at] = 1;
      const Triangle& f = faces[outs[at].face];
      const std::size_t corner = f[0] == v ? 0 : f[1] == v ? 1 : 2;
      const std::uint32_t previous = f[(corner + 2) % 3];
      for (std::size_t other = 0; other < outs.size(); ++other) {
        if (seen[other] == 0 && outs[other].to == previous) {
          at = other;
          break;
        }
      }
    }
  };
  for (std::size_t o = 0; o < outs.size(); ++o) {
    if (edges.face(outs[o].to, v) < 0) {
      ++fans;
      walk(o);
    }
  }
  for (std::size_t o = 0; o < outs.size(); ++o) {
    if (seen[o] == 0) {
      ++fans;
      walk(o);
    }
  }
  return fans;
}

}  // namespace

MeshReport check_mesh(const Mesh& mesh) {
  MeshReport report;
  report.vertices = mesh.positions.size();
  report.faces = mesh.faces.size();
  std::vector<Triangle> faces;
  faces.reserve(mesh.faces.size());
  std::size_t thin = 0;
  report.min_angle_rad = mesh.faces.empty() ? 0 : kPi;
  for (const Triangle& f : mesh.faces) {
    const bool in_range =
        std::all_of(f.begin(), f.end(), [&](std::uint32_t v) { return v < report.vertices; });
    if (!in_range || f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) {
      ++report.degenerate_faces;
      continue;
    }
    faces.push_back(f);
    const Vector3d a = mesh.positions[f[0]].cast<double>();
    const Vector3d b = mesh.positions[f[1]].cast<double>();
    const Vector3d c = mesh.positions[f[2]].cast<double>();
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const double angle = smallest_angle_rad(a, b, c);
    if (!(area > 0) || !std::isfinite(area)) {
      ++report.degenerate_faces;
    } else {
      report.area_mm2 += area;
    }
    report.min_angle_rad = std::min(report.min_angle_rad, angle);
    thin += angle < rad_from_deg(10.0) ? 1 : 0;
  }
  report.thin_share = faces.empty() ? 0 : static_cast<double>(thin) / static_cast<double>(faces.size());

  std::vector<Triangle> sorted = faces;
  for (Triangle& f : sorted) {
    std::sort(f.begin(), f.end());
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    report.duplicate_faces += sorted[i] == sorted[i - 1] ? 1 : 0;
  }

  const HalfEdges edges(faces, report.vertices);
  std::vector<std::uint8_t> inconsistent(faces.size(), 0);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = faces[i][k];
      const std::uint32_t b = faces[i][(k + 1) % 3];
      const int same = edges.count(a, b);
      const int opposite = edges.count(b, a);
      if (same + opposite == 1) {
        ++report.boundary_edges;
        report.boundary_length_mm += (mesh.positions[b] - mesh.positions[a]).cast<double>().norm();
      }
      // Each edge is counted once: at its first half-edge, from the lower vertex where both run.
      const bool counted_here = static_cast<std::size_t>(edges.face(a, b)) == i && (a < b || opposite == 0);
      if (same + opposite > 2 && counted_here) {
        ++report.non_manifold_edges;
      }
      if (same == 2 && opposite == 0) {
        report.inconsistent_edges += counted_here ? 1 : 0;
        inconsistent[i] = 1;
      }
    }
  }
  report.inconsistent_faces =
      static_cast<std::size_t>(std::count(inconsistent.begin(), inconsistent.end(), std::uint8_t{1}));
  for (std::uint32_t v = 0; v < report.vertices; ++v) {
    const auto outs = edges.from(v);
    if (outs.empty()) {
      ++report.unreferenced_vertices;
      continue;
    }
    report.box.extend(mesh.positions[v]);
    report.non_manifold_vertices += fan_count(faces, edges, v) > 1 ? 1 : 0;
  }
  const FaceComponents parts = face_components(faces, edges);
  report.components = parts.sizes.size();
  report.largest_component =
      parts.sizes.empty() ? 0 : *std::max_element(parts.sizes.begin(), parts.sizes.end());
  for (const auto& loop : boundary_loops(faces, edges)) {
    ++report.boundary_loops;
    double length = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      length += (mesh.positions[loop[(i + 1) % loop.size()]] - mesh.positions[loop[i]]).cast<double>().norm();
    }
    report.longest_boundary_loop_mm = std::max(report.longest_boundary_loop_mm, length);
  }
  report.self_intersections = self_intersections(mesh.positions, mesh.faces).size();
  return report;
}

}  // namespace dubsar
