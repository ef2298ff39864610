// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh_part.h"
#include "core/result.h"

namespace dubsar {

/// The named selections of one mesh: selections.json (docs/formats/selections.md).
struct SelectionFile {
  std::string mesh;                       ///< file name of the mesh
  std::string surface_xxh128;             ///< surface_digest() of the mesh whose faces and vertices are meant
  std::vector<MeshSelection> selections;  ///< names differ
};

/// Of the vertices and the faces between them, 32 hexadecimal digits: another mesh, or the same one stitched
/// anew, numbers its faces in another way.
[[nodiscard]] std::string surface_digest(const Mesh& mesh);

[[nodiscard]] std::string selections_to_json(const SelectionFile& file);
[[nodiscard]] Status write_selections(const std::filesystem::path& path, const SelectionFile& file);
[[nodiscard]] Result<SelectionFile> parse_selections(std::string_view text, const std::string& where);
[[nodiscard]] Result<SelectionFile> read_selections(const std::filesystem::path& path);

}  // namespace dubsar
