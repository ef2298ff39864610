// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/node_grid.h"
#include "core/mesh.h"

namespace dubsar {

/// The surface where the values cross `level`, as triangles (naive surface nets: one vertex per crossed
/// cell, at the mean of the crossings of its edges). Counter-clockwise seen from where the values are below
/// the level; normals from the gradient of the values.
[[nodiscard]] Mesh surface_nets(const NodeGrid& grid, const std::vector<float>& value, float level);

}  // namespace dubsar
