// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/free_surface.h"
#include "analysis/height_surface.h"
#include "analysis/openness.h"
#include "analysis/reconstruction.h"
#include "analysis/vertex_graph.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/stage_times.h"

namespace dubsar {

/// Everything that the wedge analysis knows of each vertex (seed 000, 3.1 to 3.3). All arrays [V].
struct SurfaceFields {
  std::vector<float> reliability;            ///< [0,1], by dilation and erosion, times the mesh's own
  std::vector<Eigen::Vector3f> normal;       ///< unit, area-weighted, out of the clay; zero without a face
  std::vector<float> mean_curvature_per_mm;  ///< positive where convex (out of the clay)
  std::vector<float> gaussian_curvature_per_mm2;
  std::vector<float> openness;             ///< ambient occlusion: 1 unoccluded, 0 buried
  std::vector<std::uint8_t> free_surface;  ///< 1: free surface
  std::vector<float> height_mm;            ///< signed distance to `surface`; negative below it
  double mean_edge_mm = 0;
  HeightSurface surface;  ///< the reconstructed surface, for exit points and outer edges; of the first body
  /// Where the mesh holds several bodies (analysis/mesh_bodies.h): the body of each vertex, [V], and the
  /// surfaces of all but the first. Both empty where it holds one.
  std::vector<std::uint8_t> body_of;
  std::vector<HeightSurface> further_surfaces;

  [[nodiscard]] std::size_t body_count() const { return 1 + further_surfaces.size(); }
  /// That of the body which the vertex belongs to.
  [[nodiscard]] const HeightSurface& surface_at(std::uint32_t vertex) const {
    const std::size_t body = body_of.empty() ? 0 : body_of[vertex];
    return body == 0 ? surface : further_surfaces[body - 1];
  }
};

struct SurfaceFieldOptions {
  int reliability_iterations = 2;  ///< n of seed 000, 3.1
  OpennessOptions openness;
  /// Histogram equalisation of the openness, before the free surface is told by it. Its thresholds are then
  /// shares of the vertices, which differ from tablet to tablet: off unless asked for.
  bool equalize_openness = false;
  FreeSurfaceOptions free_surface;
  ReconstructionOptions reconstruction;
};

/// Which way the surface at large looks at each vertex, [V]: the normal of the height surface, or the
/// vertex's own where that is out of reach.
[[nodiscard]] std::vector<Eigen::Vector3f> outlook_of(const Mesh& mesh, const SurfaceFields& fields);

/// All fields of a mesh in millimetres, faults and all: of each body as if it were alone. The same bytes for
/// any number of threads.
/// Errors: kBadInput for a mesh without a face that has an area, kCancelled.
[[nodiscard]] Result<SurfaceFields> compute_surface_fields(const Mesh& mesh, const VertexGraph& graph,
                                                           const SurfaceFieldOptions& options,
                                                           const JobContext& job,
                                                           StageTimes* timings_s = nullptr);

}  // namespace dubsar
