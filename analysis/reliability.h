// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "analysis/vertex_graph.h"
#include "core/mesh.h"

namespace dubsar {

/// How far each vertex can be trusted, [V] in [0,1] (seed 000, 3.1). Faces with an open edge or a vertex
/// that is not 2-manifold (its faces do not make one fan, or run against each other) are selected; the
/// selection is dilated n times over the 1-ring of faces and eroded n + 1 times; a face deselected in
/// erosion i gets r = (n + 1 − i) / (n + 1), one never deselected 0, one never selected 1. A vertex is as
/// reliable as the least reliable of its faces, times the mesh's own reliability; one without a face is not.
/// iterations >= 0.
[[nodiscard]] std::vector<float> vertex_reliability(const Mesh& mesh, const VertexGraph& graph,
                                                    int iterations);

}  // namespace dubsar
