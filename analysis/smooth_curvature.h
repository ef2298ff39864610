// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/vertex_geometry.h"
#include "core/mesh.h"

namespace dubsar {

/// Mean curvature at the scale of `scale_mm`, [V], convex positive: free of the noise of single vertices,
/// which the curvature of a 1-ring is not (20 µm of noise at 50 µm spacing make ±20 per mm there). Vertices
/// are gathered by cells of that size; between a cell and those around it, (n_j − n_i)·(p_j − p_i) /
/// |p_j − p_i|² is the normal curvature in that direction, and its mean over the directions the mean
/// curvature. The scale is made coarser where the mesh is.
[[nodiscard]] std::vector<float> smooth_mean_curvature(const Mesh& mesh, const VertexGeometry& geometry,
                                                       float scale_mm);

}  // namespace dubsar
