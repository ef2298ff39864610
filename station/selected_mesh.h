// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// The mesh that a session keeps.
inline constexpr const char* kSessionMesh = "mesh/model.ply";

// Selections name faces and vertices by their numbers, and a mesh that is stitched anew has others: without
// the one that they were made on they tell nothing.

/// To be called before `next` takes the place of the session's mesh. Where analysis/selections.json is of the
/// mesh that stands there, and not of the next one, that mesh stays as mesh/model.of-selections-N.ply, with
/// its checksum, and the log says so. Selections that cannot be read are of no mesh. Errors: kStorage.
[[nodiscard]] Status keep_selected_mesh(SessionStore& store, const Mesh& next);

/// The meshes that a session has of these selections, by their digest, as names in it: its own first.
[[nodiscard]] std::vector<std::string> meshes_of_selections(const std::filesystem::path& session,
                                                            const std::string& surface_xxh128);

/// The first of them of the session, or of the package (kept/), in which this file of selections lies;
/// nothing where none is there, and for a file that cannot be read.
[[nodiscard]] std::optional<std::filesystem::path> mesh_of_selections(
    const std::filesystem::path& selections);

/// All meshes that stayed for selections, those too whose selections were put aside since, as names in it.
[[nodiscard]] std::vector<std::string> kept_selected_meshes(const std::filesystem::path& session);

}  // namespace dubsar
