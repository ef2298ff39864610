// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "analysis/integral_invariants.h"
#include "analysis/openness.h"
#include "analysis/vertex_geometry.h"
#include "core/job.h"
#include "core/mesh.h"

namespace dubsar {

/// vertex_openness() of each body (analysis/mesh_bodies.h) as if it were alone: two bodies hide the sky from
/// each other. [V]; empty when cancelled.
[[nodiscard]] std::vector<float> openness_of_bodies(const Mesh& mesh, const VertexGeometry& geometry,
                                                    const OpennessOptions& options, const JobContext& job);

/// integral_invariants() of each body of the mesh as if it were alone: seen along one direction, one body
/// would cover what lies behind it of another. body_of: [V] as MeshBodies::of, empty where there is one body.
/// outlook: [V]. All are drawn as finely as mean_edge_mm, that of the whole mesh, says. Vertices of scraps
/// (VertexGeometry::box) that lie off their body by more than the largest sphere get 0, wherever they lie.
/// Empty when cancelled; the same for any number of threads.
[[nodiscard]] IntegralInvariants invariants_of_bodies(
    const Mesh& mesh, const std::vector<std::uint8_t>& body_of, const std::vector<Eigen::Vector3f>& outlook,
    double mean_edge_mm, const IntegralInvariantOptions& options, const JobContext& job);

}  // namespace dubsar
