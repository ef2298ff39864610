// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/units.h"
#include "triangulation/half_edges.h"
#include "triangulation/self_intersections.h"
#include "triangulation/triangle_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;

/// How many fans the faces around a vertex form, joined across edges of exactly two opposite half-edges.
int fan_count(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v) {
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

constexpr std::size_t kGrain = 8192;

/// A face that is one: its corners are vertices of the mesh, and three.
bool has_three_corners(const Triangle& f, std::size_t vertices) {
  return std::all_of(f.begin(), f.end(), [&](std::uint32_t v) { return v < vertices; }) && f[0] != f[1] &&
         f[1] != f[2] && f[2] != f[0];
}

void check_shapes(const Mesh& mesh, MeshReport& report) {
  struct Shapes {
    std::size_t faces = 0, degenerate = 0, thin = 0;
    double area_mm2 = 0;
    double least_tangent = std::numeric_limits<double>::infinity();
  };
  const double thin_below = std::tan(rad_from_deg(10.0));
  const Shapes all = parallel_reduce_ordered(
      mesh.faces.size(), kGrain, Shapes{},
      [&](std::size_t begin, std::size_t end) {
        Shapes part;
        for (std::size_t i = begin; i < end; ++i) {
          const Triangle& f = mesh.faces[i];
          if (!has_three_corners(f, mesh.positions.size())) {
            ++part.degenerate;
            continue;
          }
          ++part.faces;
          const Vector3d a = mesh.positions[f[0]].cast<double>();
          const Vector3d b = mesh.positions[f[1]].cast<double>();
          const Vector3d c = mesh.positions[f[2]].cast<double>();
          const double area = 0.5 * (b - a).cross(c - a).norm();
          if (!(area > 0) || !std::isfinite(area)) {
            ++part.degenerate;
          } else {
            part.area_mm2 += area;
          }
          const double tangent = least_tangent(a, b, c);
          part.least_tangent = std::min(part.least_tangent, tangent);
          part.thin += tangent < thin_below ? 1 : 0;
        }
        return part;
      },
      [](Shapes& total, const Shapes& part) {
        total.faces += part.faces;
        total.degenerate += part.degenerate;
        total.thin += part.thin;
        total.area_mm2 += part.area_mm2;
        total.least_tangent = std::min(total.least_tangent, part.least_tangent);
      });
  report.degenerate_faces = all.degenerate;
  report.area_mm2 = all.area_mm2;
  report.min_angle_rad = all.faces == 0 ? 0 : std::atan(all.least_tangent);
  report.thin_share = all.faces == 0 ? 0 : static_cast<double>(all.thin) / static_cast<double>(all.faces);
}

/// Whether a face before this one has the same three vertices.
bool repeats_another(std::span<const Triangle> faces, const HalfEdges& edges, std::size_t at) {
  Triangle sorted = faces[at];
  std::sort(sorted.begin(), sorted.end());
  const auto outs = edges.from(sorted[0]);
  return std::any_of(outs.begin(), outs.end(), [&](const HalfEdges::Out& out) {
    if (out.face >= at) {
      return false;
    }
    Triangle other = faces[out.face];
    std::sort(other.begin(), other.end());
    return other == sorted;
  });
}

void check_edges(const Mesh& mesh, std::span<const Triangle> faces, const HalfEdges& edges,
                 MeshReport& report) {
  struct Edges {
    std::size_t boundary = 0, non_manifold = 0, inconsistent = 0, inconsistent_faces = 0, duplicates = 0;
    double boundary_mm = 0;
  };
  const Edges all = parallel_reduce_ordered(
      faces.size(), kGrain, Edges{},
      [&](std::size_t begin, std::size_t end) {
        Edges part;
        for (std::size_t i = begin; i < end; ++i) {
          bool inconsistent = false;
          for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = faces[i][k];
            const std::uint32_t b = faces[i][(k + 1) % 3];
            const int same = edges.count(a, b);
            const int opposite = edges.count(b, a);
            if (same + opposite == 1) {
              ++part.boundary;
              part.boundary_mm += (mesh.positions[b] - mesh.positions[a]).cast<double>().norm();
            }
            // Each edge is counted once: at its first half-edge, from the lower vertex where both run.
            const bool odd = same + opposite > 2 || (same == 2 && opposite == 0);
            const bool counted_here =
                odd && static_cast<std::size_t>(edges.face(a, b)) == i && (a < b || opposite == 0);
            part.non_manifold += counted_here && same + opposite > 2 ? 1 : 0;
            if (same == 2 && opposite == 0) {
              part.inconsistent += counted_here ? 1 : 0;
              inconsistent = true;
            }
          }
          part.inconsistent_faces += inconsistent ? 1 : 0;
          part.duplicates += repeats_another(faces, edges, i) ? 1 : 0;
        }
        return part;
      },
      [](Edges& total, const Edges& part) {
        total.boundary += part.boundary;
        total.non_manifold += part.non_manifold;
        total.inconsistent += part.inconsistent;
        total.inconsistent_faces += part.inconsistent_faces;
        total.duplicates += part.duplicates;
        total.boundary_mm += part.boundary_mm;
      });
  report.boundary_edges = all.boundary;
  report.boundary_length_mm = all.boundary_mm;
  report.non_manifold_edges = all.non_manifold;
  report.inconsistent_edges = all.inconsistent;
  report.inconsistent_faces = all.inconsistent_faces;
  report.duplicate_faces = all.duplicates;
}

void check_vertices(const Mesh& mesh, std::span<const Triangle> faces, const HalfEdges& edges,
                    MeshReport& report) {
  struct Vertices {
    std::size_t unreferenced = 0, non_manifold = 0;
    Eigen::AlignedBox3f box;
  };
  const Vertices all = parallel_reduce_ordered(
      mesh.positions.size(), kGrain, Vertices{},
      [&](std::size_t begin, std::size_t end) {
        Vertices part;
        for (std::size_t i = begin; i < end; ++i) {
          const auto v = static_cast<std::uint32_t>(i);
          if (edges.from(v).empty()) {
            ++part.unreferenced;
          } else {
            part.box.extend(mesh.positions[v]);
            part.non_manifold += fan_count(faces, edges, v) > 1 ? 1 : 0;
          }
        }
        return part;
      },
      [](Vertices& total, const Vertices& part) {
        total.unreferenced += part.unreferenced;
        total.non_manifold += part.non_manifold;
        total.box.extend(part.box);
      });
  report.unreferenced_vertices = all.unreferenced;
  report.non_manifold_vertices = all.non_manifold;
  report.box = all.box;
}

void check_parts(const Mesh& mesh, std::span<const Triangle> faces, const HalfEdges& edges,
                 MeshReport& report) {
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
}

MeshReport check(const Mesh& mesh, bool with_parts) {
  MeshReport report;
  report.vertices = mesh.positions.size();
  report.faces = mesh.faces.size();
  check_shapes(mesh, report);
  const auto sound = [&](const Triangle& f) { return has_three_corners(f, mesh.positions.size()); };
  std::vector<Triangle> copied;
  std::span<const Triangle> faces = mesh.faces;
  if (!std::all_of(faces.begin(), faces.end(), sound)) {
    std::copy_if(faces.begin(), faces.end(), std::back_inserter(copied), sound);
    faces = copied;
  }
  const HalfEdges edges(faces, report.vertices);
  check_edges(mesh, faces, edges, report);
  check_vertices(mesh, faces, edges, report);
  if (with_parts) {
    check_parts(mesh, faces, edges, report);
  }
  return report;
}

}  // namespace

MeshReport check_manifold(const Mesh& mesh) {
  return check(mesh, false);
}

MeshReport check_mesh(const Mesh& mesh) {
  MeshReport report = check(mesh, true);  // gives its memory back before what needs as much again
  report.self_intersections = self_intersections(mesh.positions, mesh.faces).size();
  return report;
}

}  // namespace dubsar
