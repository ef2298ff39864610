// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// Vertices without a face and faces without three different corners, where write_mesh() leaves these out of
/// a file of that name: both where it compresses, of an STL the vertices.
struct LeftOut {
  std::size_t vertices = 0;
  std::size_t faces = 0;
};
[[nodiscard]] LeftOut left_out_of(const Mesh& mesh, const std::filesystem::path& file);

/// What write_mesh() leaves out of a file of that name, said in one line, with what was passed over when the
/// mesh was read (MeshReadOptions::passed_over); nothing where the format holds all that is known of the
/// mesh, as PLY does. Normals are no loss: they follow from the faces.
[[nodiscard]] std::optional<Error> mesh_losses(const Mesh& mesh, const std::filesystem::path& file,
                                               const std::string& mend,
                                               std::span<const std::string> passed_over = {});

}  // namespace dubsar
