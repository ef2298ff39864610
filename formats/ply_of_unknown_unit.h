// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/mesh.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

/// write_mesh() of a PLY that does not say that its numbers are millimetres, for nobody knows what they are:
/// whoever reads it goes by its size, as of the mesh that it was made of.
[[nodiscard]] Status write_ply_of_unknown_unit(const std::filesystem::path& path, const Mesh& mesh,
                                               const FileLabel& label);

}  // namespace dubsar
