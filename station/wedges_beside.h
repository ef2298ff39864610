// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>

#include "core/result.h"
#include "formats/wedges_json.h"

namespace dubsar {

/// Where the wedges of a mesh lie.
struct WedgesPlace {
  std::filesystem::path file;   ///< that is there, or would be
  bool in_session = false;      ///< the session measures them; else who looks at the mesh may write them
  std::optional<Error> unread;  ///< a wedges.json of which nobody can tell whose it is; it is left alone
};

/// NAME.wedges.json; else wedges.json of the same folder, or those of the session that the mesh lies in,
/// where they say that they are of this mesh: several tablets may share a folder. A session's own model.ply
/// has the session's, measured yet or not.
[[nodiscard]] WedgesPlace wedges_beside(const std::filesystem::path& mesh);

/// By the file's name: meshes and wedges travel together from folder to folder.
[[nodiscard]] bool are_of(const WedgeFile& wedges, const std::filesystem::path& mesh);

}  // namespace dubsar
