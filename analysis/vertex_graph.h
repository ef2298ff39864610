// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace dubsar {

/// The 1-rings of all vertices, built from the edges of the faces alone, so that any mesh has one: open,
/// non-manifold, wrongly oriented. Faces with an index out of range or a vertex twice take no part; of faces
/// on the same three vertices only the first does.
struct VertexGraph {
  std::vector<std::uint32_t> start;       ///< [V + 1], into neighbour
  std::vector<std::uint32_t> neighbour;   ///< vertices of the 1-rings, ascending in each
  std::vector<std::uint32_t> face_start;  ///< [V + 1], into face
  std::vector<std::uint32_t> face;        ///< the faces at each vertex, ascending in each

  [[nodiscard]] std::size_t vertex_count() const { return start.empty() ? 0 : start.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> ring(std::uint32_t v) const {
    return {neighbour.data() + start[v], neighbour.data() + start[v + 1]};
  }
  [[nodiscard]] std::span<const std::uint32_t> faces_at(std::uint32_t v) const {
    return {face.data() + face_start[v], face.data() + face_start[v + 1]};
  }
};

/// Deterministic for any number of threads. At most 2³²−1 vertices and 715 million faces.
[[nodiscard]] VertexGraph make_vertex_graph(const Mesh& mesh);

}  // namespace dubsar
