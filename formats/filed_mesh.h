// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "formats/mesh_io.h"

namespace dubsar {

/// A mesh with what reading has made of the file's vertices: some of equal position may have become one.
struct FiledMesh {
  Mesh mesh;
  std::size_t file_vertices = 0;
  /// [file_vertices] which vertex of the mesh each has become. Empty where they are the mesh's, and of STL
  /// and GLB, whose vertices every reader counts in its own way.
  std::vector<std::uint32_t> vertex_of{};
};

/// read_mesh_bytes() with that.
[[nodiscard]] Result<FiledMesh> read_filed_mesh_bytes(std::string_view bytes, const std::string& name,
                                                      const MeshReadOptions& options = {});

// The decoders of the formats that are welded, as mesh_formats.h has them.
[[nodiscard]] Result<FiledMesh> decode_filed_ply(std::string_view bytes, const std::string& where,
                                                 const MeshReadOptions& options);
[[nodiscard]] Result<FiledMesh> decode_filed_stl(std::string_view bytes, const std::string& where,
                                                 const MeshReadOptions& options);
[[nodiscard]] Result<FiledMesh> decode_filed_glb(std::string_view bytes, const std::string& where,
                                                 const MeshReadOptions& options);
/// weld_equal_positions() that tells which vertex each has become.
[[nodiscard]] FiledMesh welded(Mesh mesh);

/// The mesh alone.
[[nodiscard]] Result<Mesh> mesh_of(Result<FiledMesh> filed);

}  // namespace dubsar
