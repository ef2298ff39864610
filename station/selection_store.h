// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/mesh_part.h"
#include "core/result.h"
#include "core/wedge.h"

namespace dubsar {

/// Where the selections of a mesh are kept: NAME.selections.json beside it, or analysis/selections.json of
/// the session that it lies in.
[[nodiscard]] std::filesystem::path selections_file_of(const std::filesystem::path& mesh);

/// The kept selections of this very surface; none where there is no file. Errors: kBadInput for a file that
/// cannot be read or that is of another surface.
[[nodiscard]] Result<std::vector<MeshSelection>> kept_selections(const std::filesystem::path& file,
                                                                 const Mesh& mesh);
/// One of them, by its name. Errors: as above, with the mesh that the file is of where that is kept beside
/// it, and kUsage when there is none of that name.
[[nodiscard]] Result<MeshSelection> kept_selection(const std::filesystem::path& file, const Mesh& mesh,
                                                   const std::string& name);
/// Writes them all; the file of another surface is put aside first (FILE.1 and so on), not lost.
[[nodiscard]] Status keep_selections(const std::filesystem::path& file, const std::string& mesh_name,
                                     const Mesh& mesh, std::vector<MeshSelection> selections);

/// The wedges whose depth point lies at a selected vertex, or at a corner of a selected face: the mesh's
/// vertex that is nearest to it decides. In their order.
[[nodiscard]] std::vector<Wedge> selected_wedges(const std::vector<Wedge>& wedges, const Mesh& mesh,
                                                 const MeshSelection& selection);

}  // namespace dubsar
