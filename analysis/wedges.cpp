// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedges.h"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "analysis/height_noise.h"
#include "analysis/inner_edges.h"
#include "analysis/wedge_fragments.h"
#include "analysis/wedge_measure.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Clock = std::chrono::steady_clock;

/// A patch never holds more: what is larger is no wedge but a broken face.
constexpr std::size_t kMostVertices = 400000;
/// What one basin holds besides its first wedge is looked at so many times.
constexpr int kMostPerBasin = 4;
/// Noise that is this share of the spacing turns a triangle's normal by some 8 degrees.
constexpr double kNoisyShare = 0.1;
constexpr std::size_t kNormalSamples = 64;

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

/// Everything that looking at one basin needs.
class Extractor {
 public:
  Extractor(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
            const WedgeOptions& options, const std::vector<float>& areas, bool noisy)
      : fields_(fields),
        options_(options),
        areas_(areas),
        source_{&graph,           mesh.faces, areas, mesh.positions, fields.normal, fields.reliability,
                fields.height_mm, noisy} {}

  [[nodiscard]] std::vector<WedgeCandidate> look_at(std::span<const std::uint32_t> vertices,
                                                    std::vector<std::int32_t>* slot) const {
    std::vector<WedgeCandidate> found;
    std::vector<std::vector<std::uint32_t>> open;
    open.emplace_back(vertices.begin(), vertices.end());
    for (int turn = 0; turn < kMostPerBasin && !open.empty(); ++turn) {
      const std::vector<std::uint32_t> part = std::move(open.front());
      open.erase(open.begin());
      const std::uint32_t lowest = part.front();
      const auto reject = [&](std::string reason) {
        WedgeCandidate none;
        none.wedge.depth_point_mm = source_.position[lowest].cast<double>();
        for (const std::uint32_t v : part) {
          none.hollow_mm2 += areas_[v];
        }
        none.rejected = std::move(reason);
        found.push_back(std::move(none));
      };
      if (part.size() < least_vertices()) {
        continue;  // the grain of the clay
      }
      if (part.size() > kMostVertices) {
        reject("too large a hollow");
        continue;
      }
      if (-source_.height_mm[lowest] < options_.judge.min_depth_mm) {
        if (turn == 0) {
          reject("too shallow");
        }
        continue;
      }
      const Eigen::Vector3d up = up_over(part);
      if (!(up.squaredNorm() > 0.5)) {
        reject("no free surface above it");
        continue;
      }
      const WedgePatch patch = make_patch(source_, part, up, slot);
      const auto faces = find_faces(patch, options_.faces);
      if (!faces) {
        if (turn == 0) {
          reject(faces.error());
        }
        continue;
      }
      const InnerEdges edges = find_inner_edges(patch, *faces);
      found.push_back(measure_wedge(patch, *faces, edges, fields_.surface, areas_, options_.exits));
      leftovers(patch, *faces, least_vertices(), &open);
    }
    return found;
  }

 private:
  [[nodiscard]] std::size_t least_vertices() const {
    return static_cast<std::size_t>(std::max(options_.judge.least_vertices, 1));
  }

  /// Mean normal of the free surface over the hollow: where a wedge runs round the tablet's rim, the one over
  /// its depth point says little of where its tail rises. Zero where there is no surface.
  [[nodiscard]] Eigen::Vector3d up_over(std::span<const std::uint32_t> vertices) const {
    const std::size_t step = 1 + vertices.size() / kNormalSamples;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < vertices.size(); i += step) {
      sum += fields_.surface.normal(source_.position[vertices[i]]).cast<double>();
    }
    return sum.norm() > 1e-3 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::Zero();
  }

  /// Connected parts of the patch that its wedge does not explain and that lie well below the surface.
  static void leftovers(const WedgePatch& patch, const WedgeFaces& faces, std::size_t least,
                        std::vector<std::vector<std::uint32_t>>* open) {
    std::vector<std::uint8_t> free(patch.size());
    for (std::size_t i = 0; i < patch.size(); ++i) {
      free[i] = i < patch.inner && faces.face[i] < 0 &&
                        patch.height[i] < -0.15F * static_cast<float>(patch.depth_mm)
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

  const SurfaceFields& fields_;
  const WedgeOptions& options_;
  const std::vector<float>& areas_;
  PatchSource source_;
};

void note_time(StageTimes* timings_s, const char* stage, Clock::time_point* from) {
  const Clock::time_point now = Clock::now();
  if (timings_s != nullptr) {
    timings_s->emplace_back(stage, std::chrono::duration<double>(now - *from).count());
  }
  *from = now;
}

/// How often the heights are averaged before the watershed, so that noise alone makes no basins.
int smoothing_rounds(double noise_mm) {
  constexpr double kQuietMm = 0.003;
  constexpr int kMost = 4;
  // Each round takes part of what the last has left.
  return noise_mm <= kQuietMm
             ? 0
             : std::clamp(static_cast<int>(std::ceil(std::pow(noise_mm / kQuietMm, 2) / 7.0)), 1, kMost);
}

/// Edge of the equilateral triangle that the mean vertex stands for.
double mean_spacing_mm(const std::vector<float>& areas) {
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  return std::sqrt(1.155 * area / std::max<double>(1.0, static_cast<double>(areas.size())));
}

BasinOptions basin_options(const WedgeOptions& options, const std::vector<float>& areas) {
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  const double each = area / std::max<double>(1.0, static_cast<double>(areas.size()));
  BasinOptions out;
  out.classical = options.classical_watershed;
  out.min_vertices =
      static_cast<std::uint32_t>(std::clamp(options.min_basin_mm2 / std::max(each, 1e-9), 6.0, 1e6));
  out.min_depth_mm = static_cast<float>(options.min_basin_depth_mm);
  return out;
}

}  // namespace

Result<WedgeSet> find_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                             const WedgeOptions& options, const JobContext& job, StageTimes* timings_s) {
  Clock::time_point from = Clock::now();
  const auto cancelled = [] { return fail(ErrorKind::kCancelled, "stopped while finding wedges"); };
  job.progress("watershed", 0);
  const std::vector<float> areas = vertex_areas(mesh, graph);
  const double noise_mm = height_noise_mm(graph, fields.height_mm, fields.free_surface);
  const int rounds = smoothing_rounds(noise_mm);
  Basins basins =
      find_basins(graph, rounds > 0 ? smooth_heights(graph, fields.height_mm, rounds) : fields.height_mm,
                  fields.free_surface, basin_options(options, areas));
  note_time(timings_s, "watershed", &from);
  if (job.cancelled()) {
    return cancelled();
  }

  job.progress("wedges", 0);
  const Extractor extractor(mesh, graph, fields, options, areas,
                            noise_mm > kNoisyShare * mean_spacing_mm(areas));
  std::vector<std::vector<WedgeCandidate>> found(basins.count());
  tbb::enumerable_thread_specific<std::vector<std::int32_t>> slots(
      [&] { return std::vector<std::int32_t>(mesh.positions.size(), -1); });
  parallel_for_each_index(
      basins.count(),
      [&](std::size_t b) {
        if (!job.cancelled()) {
          found[b] = extractor.look_at(basins.vertices_of(b), &slots.local());
        }
      },
      4);
  if (job.cancelled()) {
    return cancelled();
  }
  std::vector<WedgeCandidate> candidates;
  for (std::vector<WedgeCandidate>& some : found) {
    std::ranges::move(some, std::back_inserter(candidates));
  }
  note_time(timings_s, "features", &from);

  job.progress("judging", 0);
  reject_fragments(mesh.positions, &candidates);
  judge_wedges(options.judge, &candidates);
  WedgeSet set;
  set.basin_of = std::move(basins.label);
  set.wedge_of.assign(mesh.positions.size(), -1);
  set.face_of.assign(mesh.positions.size(), -1);
  for (WedgeCandidate& c : candidates) {
    if (!c.rejected.empty()) {
      set.rejected.push_back({std::move(c.rejected), c.wedge.depth_point_mm});
      continue;
    }
    c.wedge.id = static_cast<int>(set.wedges.size());
    for (std::size_t i = 0; i < c.vertices.size(); ++i) {
      set.wedge_of[c.vertices[i]] = c.wedge.id;
      set.face_of[c.vertices[i]] = c.faces[i];
    }
    set.evidence.push_back(c.evidence);
    set.wedges.push_back(std::move(c.wedge));
  }
  note_time(timings_s, "judging", &from);
  return set;
}

}  // namespace dubsar
