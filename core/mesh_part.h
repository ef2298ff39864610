// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace dubsar {

enum class MeshElement { kFace, kVertex };

/// Numbers from `first` on.
struct IndexRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  bool operator==(const IndexRange&) const = default;
};

/// Some faces or vertices of a mesh, under a name.
struct MeshSelection {
  std::string name;
  MeshElement of = MeshElement::kFace;
  std::vector<IndexRange> ranges;  ///< rising, not touching each other, none empty
  bool operator==(const MeshSelection&) const = default;
};

/// Indices in any order, some perhaps more than once, as ranges.
[[nodiscard]] std::vector<IndexRange> ranges_of(std::vector<std::uint32_t> indices);
/// The indices, rising.
[[nodiscard]] std::vector<std::uint32_t> indices_of(const std::vector<IndexRange>& ranges);
[[nodiscard]] std::size_t count_of(const std::vector<IndexRange>& ranges);
/// Whether the mesh has all that is selected.
[[nodiscard]] bool fits(const MeshSelection& selection, const Mesh& mesh);

/// [V] 1 for the vertices that are selected, or that are a corner of a selected face. The selection fits.
[[nodiscard]] std::vector<std::uint8_t> selected_vertices(const Mesh& mesh, const MeshSelection& selection);
/// A mesh of its own: the selected faces with their corners, or the selected vertices with the faces between
/// them, and all that is known of the vertices. The selection fits. Numbers rise as they do in `mesh`.
[[nodiscard]] Mesh part_of(const Mesh& mesh, const MeshSelection& selection);

}  // namespace dubsar
