// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "triangulation/half_edges.h"

namespace dubsar {

/// Makes an oriented 2-manifold of any faces whose indices are in range, by the least deletion this finds in
/// one pass over the faces in order: faces with a repeated vertex and repeated half-edges go (the later face
/// yields), then each vertex with several fans is split, one copy per fan. Returns, for each vertex that was
/// appended, the one it copies. With `only` given, vertices v with only[v] == 0 are known to be in order, and
/// so are the half-edges that leave them: they are not looked at. Of a job that is cancelled no vertex is
/// split.
[[nodiscard]] std::vector<std::uint32_t> make_manifold(std::vector<Triangle>& faces, std::size_t vertex_count,
                                                       std::span<const std::uint8_t> only = {},
                                                       const JobContext& job = {});

/// Drops vertices without a face; per-vertex arrays follow, the order stays.
void compact_vertices(Mesh& mesh);

}  // namespace dubsar
