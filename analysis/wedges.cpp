// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedges.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/height_noise.h"
#include "analysis/hollow_measure.h"
#include "analysis/mesh_bodies.h"
#include "analysis/wedge_corrections.h"
#include "analysis/wedge_fragments.h"
#include "analysis/wedge_ids.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

/// How often the heights are averaged before the watershed, so that noise alone makes no basins.
int smoothing_rounds(double noise_mm) {
  constexpr double kQuietMm = 0.003;
  constexpr int kMost = 4;
  // Each round takes part of what the last has left.
  return noise_mm <= kQuietMm
             ? 0
             : std::clamp(static_cast<int>(std::ceil(std::pow(noise_mm / kQuietMm, 2) / 7.0)), 1, kMost);
}

BasinOptions basin_options(const WedgeOptions& options, const std::vector<float>& areas) {
  BasinOptions out;
  out.classical = options.classical_watershed;
  out.min_vertices = static_cast<std::uint32_t>(
      std::clamp(options.min_basin_mm2 / std::max(mean_area_mm2(areas), 1e-9), 6.0, 1e6));
  out.min_depth_mm = static_cast<float>(options.min_basin_depth_mm);
  return out;
}

/// Of a mesh that is one body.
Result<WedgeFindings> candidates_of_body(const Mesh& mesh, const VertexGraph& graph,
                                         const SurfaceFields& fields, const WedgeOptions& options,
                                         const JobContext& job, StageTimes* timings_s) {
  LapClock clock(timings_s);
  const auto cancelled = [] { return fail(ErrorKind::kCancelled, "stopped while finding wedges"); };
  job.progress("watershed", 0);
  WedgeFindings out;
  out.area_mm2 = vertex_areas(mesh, graph);
  const double noise_mm = height_noise_mm(graph, fields.height_mm, fields.free_surface);
  const bool noisy = is_noisy(noise_mm, out.area_mm2);
  out.is_noisy = {static_cast<std::uint8_t>(noisy ? 1 : 0)};
  const int rounds = smoothing_rounds(noise_mm);
  Basins basins =
      find_basins(graph, rounds > 0 ? smooth_heights(graph, fields.height_mm, rounds) : fields.height_mm,
                  fields.free_surface, basin_options(options, out.area_mm2));
  clock.done("watershed");
  if (job.cancelled()) {
    return cancelled();
  }

  job.progress("wedges", 0);
  const HollowMeasure measure(mesh, graph, fields, options, out.area_mm2, noisy);
  std::vector<std::vector<WedgeCandidate>> found(basins.count());
  tbb::enumerable_thread_specific<std::vector<std::int32_t>> slots(
      [&] { return std::vector<std::int32_t>(mesh.positions.size(), -1); });
  parallel_for_each_index(
      basins.count(),
      [&](std::size_t b) {
        if (!job.cancelled()) {
          found[b] = measure.look_at(basins.vertices_of(b), &slots.local());
        }
      },
      4);
  if (job.cancelled()) {
    return cancelled();
  }
  for (std::vector<WedgeCandidate>& some : found) {
    std::ranges::move(some, std::back_inserter(out.candidates));
  }
  clock.done("features");

  job.progress("judging", 0);
  reject_fragments(mesh.positions, &out.candidates);
  judge_wedges(options.judge, &out.candidates);
  out.basin_of = std::move(basins.label);
  clock.done("judging");
  return out;
}

/// What is known of some vertices of the whole, as of a mesh of theirs.
SurfaceFields some_fields(const SurfaceFields& whole, const std::vector<std::uint32_t>& vertices) {
  SurfaceFields some;
  const auto take = [&](const auto& from, auto* to) {
    to->reserve(vertices.size());
    for (const std::uint32_t v : vertices) {
      to->push_back(from[v]);
    }
  };
  take(whole.reliability, &some.reliability);
  take(whole.normal, &some.normal);
  take(whole.mean_curvature_per_mm, &some.mean_curvature_per_mm);
  take(whole.gaussian_curvature_per_mm2, &some.gaussian_curvature_per_mm2);
  take(whole.openness, &some.openness);
  take(whole.free_surface, &some.free_surface);
  take(whole.height_mm, &some.height_mm);
  some.mean_edge_mm = whole.mean_edge_mm;
  some.surface = whole.surface_at(vertices.front());
  return some;
}

/// Adds what was found on one body to what was found on those before it.
void join(const std::vector<std::uint32_t>& vertex, std::size_t body, WedgeFindings some,
          WedgeFindings* all) {
  const std::int32_t first_basin = 1 + *std::ranges::max_element(all->basin_of);
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    const std::int32_t basin = some.basin_of[i];
    all->basin_of[vertex[i]] = basin < 0 ? basin : basin + std::max(first_basin, 0);
    all->area_mm2[vertex[i]] = some.area_mm2[i];
  }
  for (WedgeCandidate& c : some.candidates) {
    for (std::uint32_t& v : c.vertices) {
      v = vertex[v];
    }
    c.wedge.place.body = static_cast<int>(body) + 1;
    all->candidates.push_back(std::move(c));
  }
  all->is_noisy.push_back(some.is_noisy.front());
}

void sort_by_id(WedgeSet* set) {
  std::vector<std::size_t> order(set->wedges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return set->wedges[i].id; });
  std::vector<Wedge> wedges;
  std::vector<EvidenceValues> evidence;
  for (const std::size_t i : order) {
    wedges.push_back(std::move(set->wedges[i]));
    evidence.push_back(set->evidence[i]);
  }
  set->wedges = std::move(wedges);
  set->evidence = std::move(evidence);
}

}  // namespace

Result<WedgeFindings> find_candidates(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                                      const WedgeOptions& options, const JobContext& job,
                                      StageTimes* timings_s) {
  if (fields.body_of.empty()) {
    return candidates_of_body(mesh, graph, fields, options, job, timings_s);
  }
  WedgeFindings all;
  all.basin_of.assign(mesh.positions.size(), kFreeSurfaceLabel);
  all.area_mm2.assign(mesh.positions.size(), 0.0F);
  for (std::size_t body = 0; body < fields.body_count(); ++body) {
    const BodyMesh part = body_mesh(mesh, fields.body_of, body);
    StageTimes times;
    Result<WedgeFindings> found = candidates_of_body(part.mesh, make_vertex_graph(part.mesh),
                                                     some_fields(fields, part.vertex), options, job, &times);
    if (!found) {
      return found;
    }
    join(part.vertex, body, *std::move(found), &all);
    add_times(times, timings_s);
  }
  return all;
}

WedgeSet settle_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                       const WedgeOptions& options, const WedgeFindings& findings) {
  WedgeSet set;
  set.basin_of = findings.basin_of;
  set.wedge_of.assign(mesh.positions.size(), -1);
  set.face_of.assign(mesh.positions.size(), -1);
  for (const WedgeCandidate& c : findings.candidates) {
    if (!c.rejected.empty()) {
      set.rejected.push_back({c.rejected, c.wedge.depth_point_mm});
      continue;
    }
    set.evidence.push_back(c.evidence);
    set.wedges.push_back(c.wedge);
  }
  WedgeIds ids(options.earlier);
  const std::vector<int> given = ids.of_found(mesh, set.wedges);
  std::size_t k = 0;
  for (const WedgeCandidate& c : findings.candidates) {
    if (!c.rejected.empty()) {
      continue;
    }
    set.wedges[k].id = given[k];
    for (std::size_t i = 0; i < c.vertices.size(); ++i) {
      set.wedge_of[c.vertices[i]] = given[k];
      set.face_of[c.vertices[i]] = c.faces[i];
    }
    ++k;
  }
  if (!options.corrections.empty()) {
    correct_wedges(mesh, graph, fields, options, findings, &ids, &set);
  }
  sort_by_id(&set);
  set.former = ids.former(set.wedges);
  set.found_again = ids.found_again();
  set.forgot_earlier = ids.forgot_earlier();
  return set;
}

Result<WedgeSet> find_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                             const WedgeOptions& options, const JobContext& job, StageTimes* timings_s) {
  const Result<WedgeFindings> findings = find_candidates(mesh, graph, fields, options, job, timings_s);
  if (!findings) {
    return std::unexpected(findings.error());
  }
  return settle_wedges(mesh, graph, fields, options, *findings);
}

}  // namespace dubsar
