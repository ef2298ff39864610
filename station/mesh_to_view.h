// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

/// A mesh for somebody who looks at it and measures on it.
struct MeshToView {
  Mesh mesh;
  FileLabel label;            ///< of its file; where its unit is doubtful, what is made of it says that, too
  std::vector<Error> doubts;  ///< what would measure wrongly: its unit, its numbers, its faces
  /// What its numbers were taken for where nobody says it, as WedgeFile has it; else empty.
  std::string unit_assumed;
  std::optional<Error> unmeasured;  ///< why no wedges are measured of it: nobody knows its unit
};

/// Reads a mesh, or points without faces, in the unit of its wedges in `wedges_file` where these lie on it in
/// that (of `analyze --unit`, or that `analyze` took it for), else as `dubsar analyze` does without --unit.
/// Where that refuses, as its file says. Faces look outwards. Errors: those of read_mesh().
[[nodiscard]] Result<MeshToView> read_mesh_to_view(const std::filesystem::path& file,
                                                   const std::filesystem::path& wedges_file);

}  // namespace dubsar
