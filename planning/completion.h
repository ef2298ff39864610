// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/mesh_query.h"
#include "planning/model_faces.h"

namespace dubsar {

/// What the parts of a tablet that nobody has seen are expected to be: a tablet is nearly symmetric, so what
/// was seen of it is mirrored through its middle, along those of its axes whose other end was not seen. An
/// end was seen when enough of the surface faces along it, or when it comes to a closed tip, as that of a
/// cone does. The middle is where the sides stand upright, or where the surface seen so far ends. surface:
/// what was seen; query: of it. hull: its convex hull. Empty when both ends of all axes were seen.
[[nodiscard]] std::vector<Eigen::Vector3d> mirrored_points(const Mesh& surface, const MeshQuery& query,
                                                           const Mesh& hull,
                                                           std::span<const Eigen::Vector3d> corners_mm,
                                                           const ModelFaces& faces);

}  // namespace dubsar
