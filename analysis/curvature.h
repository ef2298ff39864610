// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "analysis/vertex_geometry.h"
#include "analysis/vertex_graph.h"
#include "core/mesh.h"

namespace dubsar {

/// Discrete curvature at each vertex (Meyer, Desbrun, Schröder, Barr 2003), [V]. Convex is positive.
struct Curvature {
  std::vector<float> mean_per_mm;
  std::vector<float> gaussian_per_mm2;
};

/// Mean curvature from the cotangent Laplacian along the normal, Gaussian curvature from the angle deficit,
/// both over the mixed Voronoi area. A vertex whose faces make no closed fan (an open edge, a fault) has no
/// angle deficit: it takes the mean of its neighbours that have one, 0 without any; its mean curvature keeps
/// to the normal, so that an open border of a plane reads 0. Slivers take no part.
[[nodiscard]] Curvature vertex_curvature(const Mesh& mesh, const VertexGraph& graph,
                                         const VertexGeometry& geometry);

/// The principal curvatures and their directions at one vertex.
struct PrincipalCurvature {
  float maximum_per_mm = 0, minimum_per_mm = 0;
  Eigen::Vector3f maximum_direction{0, 0, 0}, minimum_direction{0, 0, 0};  ///< unit; zero on an umbilic
};

/// Least squares over the normal curvatures along the edges (Meyer et al., section 5.2), with the mean
/// curvature held.
[[nodiscard]] PrincipalCurvature principal_curvature(const Mesh& mesh, const VertexGraph& graph,
                                                     const VertexGeometry& geometry,
                                                     const Curvature& curvature, std::uint32_t vertex);

}  // namespace dubsar
