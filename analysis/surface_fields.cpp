// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/surface_fields.h"

#include <optional>
#include <utility>

#include "analysis/curvature.h"
#include "analysis/mesh_bodies.h"
#include "analysis/reliability.h"
#include "analysis/smooth_curvature.h"
#include "analysis/vertex_geometry.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

std::unexpected<Error> stopped() {
  return fail(ErrorKind::kCancelled, "the analysis was stopped");
}

/// Of a mesh that is one body. Empty when cancelled.
std::optional<SurfaceFields> fields_of_body(const Mesh& mesh, const VertexGraph& graph,
                                            VertexGeometry geometry, const SurfaceFieldOptions& options,
                                            const JobContext& job, StageTimes* timings_s) {
  SurfaceFields fields;
  LapClock clock(timings_s);
  fields.mean_edge_mm = geometry.mean_edge_mm;
  fields.reliability = vertex_reliability(mesh, graph, options.reliability_iterations);
  clock.done("reliability");
  Curvature curvature = vertex_curvature(mesh, graph, geometry);
  fields.mean_curvature_per_mm = std::move(curvature.mean_per_mm);
  fields.gaussian_curvature_per_mm2 = std::move(curvature.gaussian_per_mm2);
  clock.done("curvature");
  if (job.cancelled()) {
    return std::nullopt;
  }
  job.progress("surface fields", 0.2);
  fields.openness = vertex_openness(mesh, geometry, options.openness, job);
  if (options.equalize_openness) {
    fields.openness = equalized(fields.openness);
  }
  clock.done("openness");
  if (job.cancelled()) {
    return std::nullopt;
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
    return std::nullopt;
  }
  job.progress("surface fields", 0.9);
  fields.height_mm.resize(mesh.positions.size());
  parallel_for_each_index(
      mesh.positions.size(),
      [&](std::size_t i) { fields.height_mm[i] = fields.surface.height_mm(mesh.positions[i]); }, 1U << 14U);
  clock.done("height");
  fields.normal = std::move(geometry.normal);
  return fields;
}

template <class T>
void put(const std::vector<T>& some, const std::vector<std::uint32_t>& where, std::vector<T>* all) {
  for (std::size_t i = 0; i < where.size(); ++i) {
    (*all)[where[i]] = some[i];
  }
}

/// Of each body as if it were alone; `whole`: of them all, without surfaces.
std::optional<SurfaceFields> fields_of_bodies(const Mesh& mesh, MeshBodies bodies, SurfaceFields whole,
                                              const SurfaceFieldOptions& options, const JobContext& job,
                                              StageTimes* timings_s) {
  const std::size_t vertices = mesh.positions.size();
  whole.reliability.resize(vertices);
  whole.mean_curvature_per_mm.resize(vertices);
  whole.gaussian_curvature_per_mm2.resize(vertices);
  whole.openness.resize(vertices);
  whole.free_surface.resize(vertices);
  whole.height_mm.resize(vertices);
  for (std::size_t b = 0; b < bodies.count; ++b) {
    const BodyMesh part = body_mesh(mesh, bodies.of, b);
    const VertexGraph graph = make_vertex_graph(part.mesh);
    StageTimes times;
    std::optional<SurfaceFields> fields =
        fields_of_body(part.mesh, graph, make_vertex_geometry(part.mesh, graph), options, job, &times);
    if (!fields) {
      return std::nullopt;
    }
    put(fields->reliability, part.vertex, &whole.reliability);
    put(fields->normal, part.vertex, &whole.normal);
    put(fields->mean_curvature_per_mm, part.vertex, &whole.mean_curvature_per_mm);
    put(fields->gaussian_curvature_per_mm2, part.vertex, &whole.gaussian_curvature_per_mm2);
    put(fields->openness, part.vertex, &whole.openness);
    put(fields->free_surface, part.vertex, &whole.free_surface);
    put(fields->height_mm, part.vertex, &whole.height_mm);
    if (b == 0) {
      whole.surface = std::move(fields->surface);
    } else {
      whole.further_surfaces.push_back(std::move(fields->surface));
    }
    add_times(times, timings_s);
  }
  whole.body_of = std::move(bodies.of);
  return whole;
}

}  // namespace

std::vector<Eigen::Vector3f> outlook_of(const Mesh& mesh, const SurfaceFields& fields) {
  std::vector<Eigen::Vector3f> outlook(mesh.positions.size());
  parallel_for_each_index(
      outlook.size(),
      [&](std::size_t i) {
        const HeightSurface& surface = fields.surface_at(static_cast<std::uint32_t>(i));
        const Eigen::Vector3f n = surface.normal(mesh.positions[i]);
        outlook[i] = n.isZero() ? fields.normal[i] : n;
      },
      1U << 14U);
  return outlook;
}

Result<SurfaceFields> compute_surface_fields(const Mesh& mesh, const VertexGraph& graph,
                                             const SurfaceFieldOptions& options, const JobContext& job,
                                             StageTimes* timings_s) {
  LapClock clock(timings_s);
  job.progress("surface fields", 0.0);
  VertexGeometry geometry = make_vertex_geometry(mesh, graph);
  if (!(geometry.total_area_mm2 > 0)) {
    return bad_input({}, "the mesh has no face with an area", "give a mesh of triangles");
  }
  MeshBodies bodies = find_bodies(mesh, geometry);
  geometry.parts = {};
  clock.done("normals");
  std::optional<SurfaceFields> fields;
  if (bodies.count == 1) {
    fields = fields_of_body(mesh, graph, std::move(geometry), options, job, timings_s);
  } else {
    SurfaceFields whole;
    whole.mean_edge_mm = geometry.mean_edge_mm;
    whole.normal = std::move(geometry.normal);
    fields = fields_of_bodies(mesh, std::move(bodies), std::move(whole), options, job, timings_s);
  }
  if (!fields) {
    return stopped();
  }
  job.progress("surface fields", 1.0);
  return *std::move(fields);
}

}  // namespace dubsar
