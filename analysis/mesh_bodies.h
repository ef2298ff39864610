// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/vertex_geometry.h"
#include "core/mesh.h"
#include "core/stage_times.h"

namespace dubsar {

/// The bodies of clay that one mesh holds: two fragments in one file hide the sky from each other, which says
/// nothing of their surfaces.
struct MeshBodies {
  std::size_t count = 1;
  std::vector<std::uint8_t> of;  ///< [V] the body of each vertex, from 0; empty where there is one only
};

/// A body is a part that hangs together, with a twentieth of the area, and whose faces look all around: a
/// tablet is in two parts where its sides were scanned from above and from below only. Parts that are open go
/// together as long as they lie within 3 mm of each other (their boxes) or look different ways; one that lies
/// so near a closed one belongs to that. Scraps go to the body they lie nearest to. Numbered by falling area,
/// then by place, whatever the order of the vertices.
[[nodiscard]] MeshBodies find_bodies(const Mesh& mesh, const VertexGeometry& geometry);

/// One body as a mesh of its own.
struct BodyMesh {
  Mesh mesh;                          ///< positions, faces and reliability
  std::vector<std::uint32_t> vertex;  ///< [of mesh] of the whole
};
[[nodiscard]] BodyMesh body_mesh(const Mesh& mesh, const std::vector<std::uint8_t>& of, std::size_t body);

/// What `measure` gives of each body as a mesh of its own, a value a vertex, put together: [V]. Of one body
/// alone, where `of` is empty, of the mesh itself. Empty where it is empty of a body (cancelled).
template <class Measure>
[[nodiscard]] auto of_each_body(const Mesh& mesh, const std::vector<std::uint8_t>& of, const Measure& measure)
    -> decltype(measure(mesh)) {
  if (of.empty()) {
    return measure(mesh);
  }
  decltype(measure(mesh)) all(mesh.positions.size());
  const std::size_t bodies = std::size_t{1} + *std::max_element(of.begin(), of.end());
  for (std::size_t b = 0; b < bodies; ++b) {
    const BodyMesh body = body_mesh(mesh, of, b);
    const auto some = measure(body.mesh);
    if (some.size() != body.vertex.size()) {
      return {};
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      all[body.vertex[i]] = some[i];
    }
  }
  return all;
}

/// Adds what stages took of one body to what they took of others.
void add_times(const StageTimes& some, StageTimes* all);

}  // namespace dubsar
