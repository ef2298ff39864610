// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/hollow_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/inner_edges.h"
#include "analysis/mesh_reach.h"
#include "analysis/wedge_numbering.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

/// A patch never holds more: what is larger is no wedge but a broken face.
constexpr std::size_t kMostVertices = 400000;
/// What one basin holds besides its first wedge is looked at so many times.
constexpr int kMostPerBasin = 4;
/// Noise that is this share of the spacing turns a triangle's normal by some 8 degrees.
constexpr double kNoisyShare = 0.1;
/// Normals over a hollow that add up to less than this, of one for all, look nowhere.
constexpr double kLeastNormal = 1e-3;
/// A mesh reaches so many spacings beyond its last vertex.
constexpr double kEndSpacings = 2.0;
constexpr const char* kTooLarge = "too large a hollow";
constexpr const char* kNoSurface = "no free surface above it";
constexpr const char* kLeft = "not looked at: four others of its basin were";

/// Connected parts of the patch that its wedge does not explain and that lie well below the surface.
void leftovers(const WedgePatch& patch, const WedgeFaces& faces, std::size_t least,
               std::vector<std::vector<std::uint32_t>>* open) {
  std::vector<std::uint8_t> free(patch.size());
  for (std::size_t i = 0; i < patch.size(); ++i) {
    free[i] =
        i < patch.inner && faces.face[i] < 0 && patch.height[i] < -0.15F * static_cast<float>(patch.depth_mm)
            ? 1
            : 0;
  }
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    if (free[i] == 0) {
      continue;
    }
    std::vector<std::uint32_t> part;
    free[i] = 0;
    stack.push_back(i);
    while (!stack.empty()) {
      const std::uint32_t v = stack.back();
      stack.pop_back();
      part.push_back(v);
      for (const std::uint32_t n : patch.graph.ring(v)) {
        if (free[n] != 0) {
          free[n] = 0;
          stack.push_back(n);
        }
      }
    }
    if (part.size() >= 2 * least) {
      std::ranges::sort(part);  // the patch is in rising height
      for (std::uint32_t& v : part) {
        v = patch.vertex[v];
      }
      open->push_back(std::move(part));
    }
  }
}

}  // namespace

std::vector<float> vertex_areas(const Mesh& mesh, const VertexGraph& graph) {
  std::vector<float> areas(mesh.positions.size());
  parallel_for_each_index(areas.size(), [&](std::size_t v) {
    float sum = 0;
    for (const std::uint32_t f : graph.faces_at(static_cast<std::uint32_t>(v))) {
      const auto& [a, b, c] = mesh.faces[f];
      sum +=
          (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm() / 6.0F;
    }
    areas[v] = std::isfinite(sum) ? sum : 0.0F;
  });
  return areas;
}

double mean_area_mm2(const std::vector<float>& areas) {
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  const auto count = std::ranges::count_if(areas, [](float a) { return a > 0; });
  return area / std::max<double>(1.0, static_cast<double>(count));
}

double mean_spacing_mm(const std::vector<float>& areas) {
  return std::sqrt(1.155 * mean_area_mm2(areas));
}

bool is_noisy(double noise_mm, const std::vector<float>& areas) {
  return noise_mm > kNoisyShare * mean_spacing_mm(areas);
}

HollowMeasure::HollowMeasure(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                             const WedgeOptions& options, const std::vector<float>& areas, bool noisy)
    : mesh_(mesh),
      fields_(fields),
      options_(options),
      areas_(areas),
      source_{.graph = &graph,
              .faces = mesh.faces,
              .area_mm2 = areas,
              .position = mesh.positions,
              .normal = fields.normal,
              .reliability = fields.reliability,
              .height_mm = fields.height_mm,
              .noisy = noisy} {}

std::size_t HollowMeasure::least_vertices() const {
  return static_cast<std::size_t>(std::max(options_.judge.least_vertices, 1));
}

/// Mean normal of the free surface over the hollow, by the area of its clay: where a wedge runs round the
/// tablet's rim, the one over its depth point says little of where its tail rises. Of every vertex: a few of
/// them, taken by height, are others after each rounding. Zero where there is no surface.
Eigen::Vector3d HollowMeasure::up_over(std::span<const std::uint32_t> vertices) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (const std::uint32_t v : vertices) {
    sum += areas_[v] * fields_.surface_at(v).normal(source_.position[v]).cast<double>();
    area += areas_[v];
  }
  return sum.norm() > kLeastNormal * area ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::Zero();
}

/// The surface without impressions goes on where the mesh has ended: how far off an exit there is, and with
/// it a length and the volume, nobody knows.
void HollowMeasure::note_ends_in_air(const HeightSurface& surface, double spacing_mm,
                                     WedgeCandidate* found) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Wedge& wedge = found->wedge;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& exit = wedge.exit_points_surface_mm[k];
    const Eigen::Vector3f normal = surface.normal(exit.cast<float>());
    const Eigen::Vector3d up = normal.isZero() ? wedge.surface_normal : normal.cast<double>().eval();
    if (!mesh_reaches(mesh_, *source_.graph, source_.normal, found->vertices, exit, up,
                      kEndSpacings * spacing_mm)) {
      wedge.beyond_mesh[k] = true;
      wedge.sigma.length_mm[k] = kUnknown;
      wedge.sigma.volume_mm3 = kUnknown;
    }
  }
}

std::expected<WedgeCandidate, std::string> HollowMeasure::measure(
    std::span<const std::uint32_t> vertices, std::vector<std::int32_t>* slot,
    std::vector<std::vector<std::uint32_t>>* open) const {
  if (vertices.size() > kMostVertices) {
    return std::unexpected(kTooLarge);
  }
  if (-source_.height_mm[vertices.front()] < options_.judge.min_depth_mm) {
    return std::unexpected("too shallow");
  }
  const Eigen::Vector3d up = up_over(vertices);
  if (!(up.squaredNorm() > 0.5)) {
    return std::unexpected(kNoSurface);
  }
  const WedgePatch patch = make_patch(source_, vertices, up, slot);
  const auto faces = find_faces(patch, options_.faces);
  if (!faces) {
    return std::unexpected(faces.error());
  }
  const InnerEdges edges = find_inner_edges(patch, *faces);
  const HeightSurface& surface = fields_.surface_at(vertices.front());
  WedgeCandidate found = measure_wedge(patch, *faces, edges, surface, areas_, options_.exits);
  found.floor_mm = patch.depth_mm;
  note_ends_in_air(surface, patch.spacing_mm, &found);
  if (!fields_.body_of.empty()) {
    found.wedge.place.body = 1 + fields_.body_of[vertices.front()];
  }
  number_from_directional_edge(&found);
  if (open != nullptr) {
    leftovers(patch, *faces, least_vertices(), open);
  }
  return found;
}

std::vector<WedgeCandidate> HollowMeasure::look_at(std::span<const std::uint32_t> vertices,
                                                   std::vector<std::int32_t>* slot) const {
  std::vector<WedgeCandidate> found;
  std::vector<std::vector<std::uint32_t>> open;
  open.emplace_back(vertices.begin(), vertices.end());
  for (int turn = 0; turn < kMostPerBasin && !open.empty(); ++turn) {
    const std::vector<std::uint32_t> part = std::move(open.front());
    open.erase(open.begin());
    if (part.size() < least_vertices()) {
      continue;  // the grain of the clay
    }
    if (auto measured = measure(part, slot, &open)) {
      found.push_back(*std::move(measured));
    } else if (turn == 0 || measured.error() == kTooLarge || measured.error() == kNoSurface) {
      WedgeCandidate none;
      none.wedge.depth_point_mm = source_.position[part.front()].cast<double>();
      for (const std::uint32_t v : part) {
        none.hollow_mm2 += areas_[v];
      }
      none.rejected = std::move(measured.error());
      found.push_back(std::move(none));
    }
  }
  // That it was left is said; what it is nobody knows, so that it is no company, good or bad (hollow_mm2).
  for (const std::vector<std::uint32_t>& part : open) {
    WedgeCandidate none;
    none.wedge.depth_point_mm = source_.position[part.front()].cast<double>();
    none.rejected = kLeft;
    found.push_back(std::move(none));
  }
  return found;
}

}  // namespace dubsar
