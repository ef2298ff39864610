// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/node_grid.h"
#include "core/mesh.h"

namespace dubsar {

/// Signed distances of the nodes to the surface where `value` crosses 0 (positive values: inside, negative
/// distances), given as triangles too; exact within below_mm under and above_mm over it, clamped beyond.
/// [nodes]
[[nodiscard]] std::vector<float> distances_near(const Mesh& surface, const NodeGrid& grid,
                                                const std::vector<float>& value, float below_mm,
                                                float above_mm);

}  // namespace dubsar
