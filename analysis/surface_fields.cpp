// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/surface_fields.h"

#include "analysis/curvature.h"
#include "analysis/reliability.h"
#include "analysis/smooth_curvature.h"
#include "analysis/vertex_geometry.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

std::unexpected<Error> stopped() {
  return fail(ErrorKind::kCancelled, "the analysis was stopped");
}

}  // namespace

std::vector<Eigen::Vector3f> outlook_of(const Mesh& mesh, const SurfaceFields& fields) {
  std::vector<Eigen::Vector3f> outlook(mesh.positions.size());
  parallel_for_each_index(
      outlook.size(),
      [&](std::size_t i) {
        const Eigen::Vector3f n = fields.surface.normal(mesh.positions[i]);
        outlook[i] = n.isZero() ? fields.normal[i] : n;
      },
      1U << 14U);
  return outlook;
}

Result<SurfaceFields> compute_surface_fields(const Mesh& mesh, const VertexGraph& graph,
                                             const SurfaceFieldOptions& options, const JobContext& job,
                                             StageTimes* timings_s) {
  SurfaceFields fields;
  LapClock clock(timings_s);
  job.progress("surface fields", 0.0);
  VertexGeometry geometry = make_vertex_geometry(mesh, graph);
  if (!(geometry.total_area_mm2 > 0)) {
    return bad_input({}, "the mesh has no face with an area", "give a mesh of triangles");
  }
  fields.mean_edge_mm = geometry.mean_edge_mm;
  clock.done("normals");
  fields.reliability = vertex_reliability(mesh, graph, options.reliability_iterations);
  clock.done("reliability");
  Curvature curvature = vertex_curvature(mesh, graph, geometry);
  fields.mean_curvature_per_mm = std::move(curvature.mean_per_mm);
  fields.gaussian_curvature_per_mm2 = std::move(curvature.gaussian_per_mm2);
  clock.done("curvature");
  if (job.cancelled()) {
    return stopped();
  }
  job.progress("surface fields", 0.2);
  fields.openness = vertex_openness(mesh, geometry, options.openness, job);
  if (options.equalize_openness) {
    fields.openness = equalized(fields.openness);
  }
  clock.done("openness");
  if (job.cancelled()) {
    return stopped();
  }
  job.progress("surface fields", 0.5);
  fields.free_surface =
      find_free_surface(fields.openness, smooth_mean_curvature(mesh, geometry, options.free_surface.scale_mm),
                        options.free_surface);
  clock.done("free surface");
  fields.surface = reconstruct_surface(mesh, geometry, fields.free_surface, fields.reliability,
                                       options.reconstruction, job);
  clock.done("poisson");
  if (job.cancelled()) {
    return stopped();
  }
  job.progress("surface fields", 0.9);
  fields.height_mm.resize(mesh.positions.size());
  parallel_for_each_index(
      mesh.positions.size(),
      [&](std::size_t i) { fields.height_mm[i] = fields.surface.height_mm(mesh.positions[i]); }, 1U << 14U);
  clock.done("height");
  fields.normal = std::move(geometry.normal);
  job.progress("surface fields", 1.0);
  return fields;
}

}  // namespace dubsar
