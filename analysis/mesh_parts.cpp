// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/mesh_parts.h"

#include <numeric>

#include "core/disjoint_sets.h"
#include "core/parallel.h"

namespace dubsar {

std::vector<std::uint32_t> MeshParts::larger_than(double share) const {
  const double least = share * std::accumulate(area_mm2.begin(), area_mm2.end(), 0.0);
  std::vector<std::uint32_t> large;
  for (std::size_t v = 0; v < area_mm2.size(); ++v) {
    if (area_mm2[v] > least) {
      large.push_back(static_cast<std::uint32_t>(v));
    }
  }
  return large;
}

MeshParts find_parts(const VertexGraph& graph, const std::vector<float>& area_mm2) {
  constexpr std::size_t kGrain = 1U << 14U;
  const std::size_t vertices = graph.vertex_count();
  DisjointSets sets(vertices);
  parallel_for_each_index(
      vertices,
      [&](std::size_t v) {
        for (const std::uint32_t w : graph.ring(static_cast<std::uint32_t>(v))) {
          if (w > v) {
            sets.unite(static_cast<std::uint32_t>(v), w);
          }
        }
      },
      kGrain);
  MeshParts parts;
  parts.of.resize(vertices);
  parallel_for_each_index(
      vertices, [&](std::size_t v) { parts.of[v] = sets.root(static_cast<std::uint32_t>(v)); }, kGrain);
  parts.area_mm2.assign(vertices, 0.0);
  for (std::size_t v = 0; v < vertices; ++v) {
    parts.area_mm2[parts.of[v]] += area_mm2[v];
  }
  return parts;
}

}  // namespace dubsar
