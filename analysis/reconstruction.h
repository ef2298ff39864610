// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/height_surface.h"
#include "analysis/screened_poisson.h"
#include "analysis/vertex_geometry.h"
#include "core/job.h"
#include "core/mesh.h"

namespace dubsar {

struct ReconstructionOptions {
  float cell_mm = 0.6F;  ///< of the Poisson grid; made coarser where the mesh is coarse or the tablet large
  float other_weight = 0.02F;  ///< of a point off the free surface, beside 1 for one on it; 1: uniform
  float full_depth_mm = 0.5F;  ///< points deeper off it weigh less, as one over their depth
  float script_mm = 12.0F;     ///< the weights are balanced over this reach: larger than an impression covers
  float band_mm = 7.0F;        ///< heights are known down to this: deeper than any wedge (JudgeOptions)
  float above_mm = 2.0F;       ///< and up to this
  std::size_t most_nodes = 16'000'000;
  PoissonOptions poisson;
};

/// The surface without impressions (seed 000, 3.3, Fig. 5): screened Poisson reconstruction of the vertices,
/// gathered by cell, each weighted by free surface and reliability; the weights are divided by their mean
/// over script_mm, so that dense text, of which little is free surface, keeps its full say. A first look on a
/// grid twice as coarse tells how deep points off the free surface lie: what draws the surface into a hollow
/// grows with the hollow's area, and what holds it above with its width only. Then the signed distance to it
/// within the band. All arrays [V]. Its mesh is empty when there was nothing to reconstruct or
/// the job was cancelled.
[[nodiscard]] HeightSurface reconstruct_surface(const Mesh& mesh, const VertexGeometry& geometry,
                                                const std::vector<std::uint8_t>& free_surface,
                                                const std::vector<float>& reliability,
                                                const ReconstructionOptions& options, const JobContext& job);

}  // namespace dubsar
