// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/mesh_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/parallel_sort.h"
#include "core/units.h"
#include "triangulation/half_edges.h"
#include "triangulation/self_intersections.h"
#include "triangulation/triangle_shape.h"
#include "triangulation/vertex_fans.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kGrain = 8192;

/// A face that is one: its corners are vertices of the mesh, and three.
bool has_three_corners(const Triangle& f, std::size_t vertices) {
  return std::all_of(f.begin(), f.end(), [&](std::uint32_t v) { return v < vertices; }) && f[0] != f[1] &&
         f[1] != f[2] && f[2] != f[0];
}

/// In doubles from the start: of floats the difference may be infinite.
double length_mm(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.positions[b].cast<double>() - mesh.positions[a].cast<double>()).norm();
}

void check_shapes(const Mesh& mesh, const JobContext& job, MeshReport& report) {
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
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
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

/// Whether a face before this one has the same three vertices: a and b, with an edge between them, and c.
bool repeats_another(std::span<const Triangle> faces, const HalfEdges& edges, std::size_t at, std::uint32_t a,
                     std::uint32_t b, std::uint32_t c) {
  const auto is_same = [&](std::uint32_t other) {
    return other < at && std::ranges::find(faces[other], c) != faces[other].end();
  };
  return edges.any_face(a, b, is_same) || edges.any_face(b, a, is_same);
}

void check_edges(const Mesh& mesh, std::span<const Triangle> faces, const HalfEdges& edges,
                 const JobContext& job, MeshReport& report) {
  struct Edges {
    std::size_t boundary = 0, non_manifold = 0, inconsistent = 0, inconsistent_faces = 0, duplicates = 0;
    double boundary_mm = 0;
  };
  const Edges all = parallel_reduce_ordered(
      faces.size(), kGrain, Edges{},
      [&](std::size_t begin, std::size_t end) {
        Edges part;
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          bool inconsistent = false;
          int fewest = std::numeric_limits<int>::max();  // faces at one of its edges, from corner
          std::size_t corner = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = faces[i][k];
            const std::uint32_t b = faces[i][(k + 1) % 3];
            const int same = edges.count(a, b);
            const int opposite = edges.count(b, a);
            if (same + opposite < fewest) {
              fewest = same + opposite;
              corner = k;
            }
            if (same + opposite == 1) {
              ++part.boundary;
              part.boundary_mm += length_mm(mesh, a, b);
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
          part.duplicates += repeats_another(faces, edges, i, faces[i][corner], faces[i][(corner + 1) % 3],
                                             faces[i][(corner + 2) % 3])
                                 ? 1
                                 : 0;
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
                    const JobContext& job, MeshReport& report) {
  struct Vertices {
    std::size_t unreferenced = 0, non_manifold = 0;
    Eigen::AlignedBox3f box;
  };
  const Vertices all = parallel_reduce_ordered(
      mesh.positions.size(), kGrain, Vertices{},
      [&](std::size_t begin, std::size_t end) {
        Vertices part;
        std::vector<std::uint32_t> fan;
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          const auto v = static_cast<std::uint32_t>(i);
          if (edges.from(v).empty()) {
            ++part.unreferenced;
          } else {
            part.box.extend(mesh.positions[v]);
            // Where all is well the first finds one fan already, and is quicker.
            part.non_manifold +=
                number_fans(faces, edges, v, fan) > 1 && !is_one_fan(faces, edges, v) ? 1 : 0;
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
                 const JobContext& job, MeshReport& report) {
  const FaceComponents parts = face_components(faces, edges, job);
  report.components = parts.sizes.size();
  report.largest_component =
      parts.sizes.empty() ? 0 : *std::max_element(parts.sizes.begin(), parts.sizes.end());
  for (const BoundaryLoop& loop : boundary_loops(faces, edges, job)) {
    ++report.boundary_loops;
    const std::vector<std::uint32_t>& v = loop.vertices;
    double length = loop.closed ? length_mm(mesh, v.back(), v.front()) : 0;
    for (std::size_t i = 1; i < v.size(); ++i) {
      length += length_mm(mesh, v[i - 1], v[i]);
    }
    report.longest_boundary_loop_mm = std::max(report.longest_boundary_loop_mm, length);
  }
}

/// Those of faces whose three vertices are those of no face before; none of a job that is cancelled.
std::vector<Triangle> without_duplicates(std::span<const Triangle> faces, const JobContext& job) {
  std::vector<std::pair<Triangle, std::uint32_t>> by_corners(faces.size());
  parallel_for_each_index(
      faces.size(),
      [&](std::size_t i) {
        Triangle corners = faces[i];
        std::ranges::sort(corners);
        by_corners[i] = {corners, static_cast<std::uint32_t>(i)};
      },
      kGrain);
  parallel_sort(by_corners.begin(), by_corners.end(), std::less<>{}, job);
  if (job.cancelled()) {
    return {};
  }
  std::vector<std::uint32_t> first;
  for (std::size_t k = 0; k < by_corners.size(); ++k) {
    if (k == 0 || by_corners[k].first != by_corners[k - 1].first) {
      first.push_back(by_corners[k].second);
    }
  }
  parallel_sort(first.begin(), first.end(), std::less<>{}, job);
  if (job.cancelled()) {
    return {};
  }
  std::vector<Triangle> out;
  out.reserve(first.size());
  for (const std::uint32_t face : first) {
    out.push_back(faces[face]);
  }
  return out;
}

/// For each vertex the first one in the very same place, whose number may be its own; -0 and 0 are one place.
/// Empty where no two lie in one, and of a job that is cancelled.
std::vector<std::uint32_t> first_in_place(const Mesh& mesh, const JobContext& job) {
  using Place = std::array<std::uint32_t, 3>;
  std::vector<std::pair<Place, std::uint32_t>> by_place(mesh.positions.size());
  parallel_for_each_index(
      by_place.size(),
      [&](std::size_t v) {
        const Eigen::Vector3f& p = mesh.positions[v];
        by_place[v] = {
            {std::bit_cast<std::uint32_t>(p.x() + 0.0F), std::bit_cast<std::uint32_t>(p.y() + 0.0F),
             std::bit_cast<std::uint32_t>(p.z() + 0.0F)},
            static_cast<std::uint32_t>(v)};
      },
      kGrain);
  parallel_sort(by_place.begin(), by_place.end(), std::less<>{}, job);
  const auto is_same = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (job.cancelled() || std::ranges::adjacent_find(by_place, is_same) == by_place.end()) {
    return {};
  }
  std::vector<std::uint32_t> first(by_place.size());
  for (std::size_t k = 0; k < by_place.size(); ++k) {
    const bool again = k > 0 && is_same(by_place[k], by_place[k - 1]);
    first[by_place[k].second] = again ? first[by_place[k - 1].second] : by_place[k].second;
  }
  return first;
}

/// Of the faces that lie in the same three places those beyond the first, but for duplicates.
std::size_t count_repeated(const Mesh& mesh, const JobContext& job) {
  const std::vector<std::uint32_t> first = first_in_place(mesh, job);
  if (first.empty()) {
    return 0;
  }
  std::vector<std::uint8_t> shared(first.size(), 0);
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) {
      shared[v] = shared[first[v]] = 1;
    }
  }
  std::vector<std::pair<Triangle, Triangle>> faces;  // by place, and as they are
  for (const Triangle& f : mesh.faces) {
    if (has_three_corners(f, first.size()) && (shared[f[0]] | shared[f[1]] | shared[f[2]]) != 0) {
      Triangle places{first[f[0]], first[f[1]], first[f[2]]};
      Triangle corners = f;
      std::ranges::sort(places);
      std::ranges::sort(corners);
      if (places[0] != places[1] && places[1] != places[2]) {  // else it has no area, and is counted so
        faces.emplace_back(places, corners);
      }
    }
  }
  parallel_sort(faces.begin(), faces.end(), std::less<>{}, job);
  std::size_t count = 0;
  for (std::size_t k = 1; k < faces.size() && !job.cancelled(); ++k) {
    count += faces[k].first == faces[k - 1].first && faces[k].second != faces[k - 1].second ? 1 : 0;
  }
  return count;
}

MeshReport check(const Mesh& mesh, bool with_parts, const JobContext& job) {
  MeshReport report;
  report.vertices = mesh.positions.size();
  report.faces = mesh.faces.size();
  check_shapes(mesh, job, report);
  const auto sound = [&](const Triangle& f) { return has_three_corners(f, mesh.positions.size()); };
  std::vector<Triangle> copied;
  std::span<const Triangle> faces = mesh.faces;
  if (!std::all_of(faces.begin(), faces.end(), sound)) {
    std::copy_if(faces.begin(), faces.end(), std::back_inserter(copied), sound);
    faces = copied;
  }
  if (job.cancelled()) {
    return report;
  }
  const HalfEdges edges(faces, report.vertices, {}, job);
  if (!job.cancelled()) {
    check_edges(mesh, faces, edges, job, report);
  }
  if (!job.cancelled()) {
    check_vertices(mesh, faces, edges, job, report);
  }
  if (with_parts && !job.cancelled()) {
    check_parts(mesh, faces, edges, job, report);
  }
  return report;
}

}  // namespace

MeshReport check_manifold(const Mesh& mesh) {
  return check(mesh, false, {});
}

MeshReport check_mesh(const Mesh& mesh, const JobContext& job, const CountWork& counted) {
  MeshReport report = check(mesh, true, job);  // gives its memory back before what needs as much again
  if (!job.cancelled()) {
    report.repeated_faces = count_repeated(mesh, job);
  }
  if (!job.cancelled()) {
    std::vector<Triangle> different;
    std::span<const Triangle> faces = mesh.faces;
    if (report.duplicate_faces > 0) {
      different = without_duplicates(faces, job);
      faces = different;
    }
    report.self_intersections = self_intersections(mesh.positions, faces, {}, job, counted).size();
  }
  return report;
}

}  // namespace dubsar
