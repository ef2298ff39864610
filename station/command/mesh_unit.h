// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// A mesh to measure, and what its numbers were taken for without anyone's word.
struct MeshInItsUnit {
  Mesh mesh;
  std::size_t file_vertices = 0;           ///< as FiledMesh has it, like the next
  std::vector<std::uint32_t> vertex_of{};  ///< of the mesh
  std::string unit_assumed;  ///< one of kLengthUnits; empty: the unit was given, stated or likely
};

/// Reads the mesh in `unit`; where that is empty in the file's own, else in millimetres (glTF: metres). Where
/// that cannot be, for nothing inscribed is of such a size, and the file states no unit of its own, it is
/// taken for the one of metres, millimetres and micrometres that makes an inscribed thing of it, with a
/// warning. kBadInput where none does, or where the file states a unit that cannot be: names the units to
/// choose from with the size that each would give.
[[nodiscard]] Result<MeshInItsUnit> read_mesh_in_its_unit(const std::string& file, const std::string& unit,
                                                          const JobContext& job);

}  // namespace dubsar
