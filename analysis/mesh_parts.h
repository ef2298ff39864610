// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/vertex_graph.h"
#include "core/mesh.h"

namespace dubsar {

/// What hangs together in a mesh.
struct MeshParts {
  std::vector<std::uint32_t> of;  ///< [V] the least vertex of the part that each belongs to
  std::vector<double> area_mm2;   ///< [V] of the part whose least vertex it is, else 0

  /// The least vertices of the parts that have more than this share of the whole area, rising.
  [[nodiscard]] std::vector<std::uint32_t> larger_than(double share) const;
};

/// area_mm2: [V] of the surface that each vertex stands for. The same for any number of threads.
[[nodiscard]] MeshParts find_parts(const VertexGraph& graph, const std::vector<float>& area_mm2);

}  // namespace dubsar
