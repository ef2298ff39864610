// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedges.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "analysis/height_noise.h"
#include "analysis/hollow_measure.h"
#include "analysis/wedge_corrections.h"
#include "analysis/wedge_fragments.h"
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

}  // namespace

Result<WedgeFindings> find_candidates(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                                      const WedgeOptions& options, const JobContext& job,
                                      StageTimes* timings_s) {
  LapClock clock(timings_s);
  const auto cancelled = [] { return fail(ErrorKind::kCancelled, "stopped while finding wedges"); };
  job.progress("watershed", 0);
  WedgeFindings out;
  out.area_mm2 = vertex_areas(mesh, graph);
  out.noise_mm = height_noise_mm(graph, fields.height_mm, fields.free_surface);
  const int rounds = smoothing_rounds(out.noise_mm);
  Basins basins =
      find_basins(graph, rounds > 0 ? smooth_heights(graph, fields.height_mm, rounds) : fields.height_mm,
                  fields.free_surface, basin_options(options, out.area_mm2));
  clock.done("watershed");
  if (job.cancelled()) {
    return cancelled();
  }

  job.progress("wedges", 0);
  const HollowMeasure measure(mesh, graph, fields, options, out.area_mm2, out.noise_mm);
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
    Wedge wedge = c.wedge;
    wedge.id = static_cast<int>(set.wedges.size());
    for (std::size_t i = 0; i < c.vertices.size(); ++i) {
      set.wedge_of[c.vertices[i]] = wedge.id;
      set.face_of[c.vertices[i]] = c.faces[i];
    }
    set.evidence.push_back(c.evidence);
    set.wedges.push_back(std::move(wedge));
  }
  if (!options.corrections.empty()) {
    correct_wedges(mesh, graph, fields, options, findings, &set);
  }
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
