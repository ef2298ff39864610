// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "analysis/vertex_graph.h"
#include "core/mesh.h"

namespace dubsar {

/// Whether there is mesh above or below a place: whether the foot of `at`, along the unit vector `up`, lies
/// in a face or within `near_mm` of a vertex. Looked for over the mesh from `from`, vertices near that place,
/// around holes that lie between; what hangs together with none of them, or is some thousand vertices away,
/// is not found, nor is the other side of a sherd round its rim. `graph`, `normal` ([V], out of the clay): of
/// this mesh.
[[nodiscard]] bool mesh_reaches(const Mesh& mesh, const VertexGraph& graph,
                                std::span<const Eigen::Vector3f> normal, std::span<const std::uint32_t> from,
                                const Eigen::Vector3d& at, const Eigen::Vector3d& up, double near_mm);

}  // namespace dubsar
