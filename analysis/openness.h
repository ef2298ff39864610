// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "analysis/vertex_geometry.h"
#include "core/job.h"
#include "core/mesh.h"

namespace dubsar {

struct OpennessOptions {
  int directions = 64;       ///< even, 2 to 512; spread over the whole sphere in opposite pairs
  int longest_map_px = 800;  ///< side of the largest depth map, 64 to 4096
};

/// Ambient occlusion of every vertex, [V] in [0,1] (seed 000, 3.2; facts.md):
/// Σ_d visible(v,d)·max(n·d,0) / Σ_d max(n·d,0), so that an unoccluded vertex reads 1 exactly. Visible is
/// what lies no deeper than the orthographic depth map of the direction, less a slope-dependent offset. One
/// projection serves a direction and its opposite. A vertex without a normal reads 0. Empty when cancelled.
[[nodiscard]] std::vector<float> vertex_openness(const Mesh& mesh, const VertexGeometry& geometry,
                                                 const OpennessOptions& options, const JobContext& job);

/// The same values spread evenly over [0,1] by rank (histogram equalisation, 1024 steps), for pictures and
/// for thresholds that are to be shares of the surface.
[[nodiscard]] std::vector<float> equalized(const std::vector<float>& values);

}  // namespace dubsar
