// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

struct MeshReadOptions {
  /// What the file's numbers are; unset: the file's own word (PLY obj_info unit), metres for glTF, else
  /// millimetres.
  std::optional<double> mm_per_unit{};
  /// A PLY or OBJ of vertices alone gives a mesh without faces, for who only looks at it.
  bool may_be_points = false;
  /// Given the names of what the file holds and a mesh does not ("vertex quality", "edge"); null: not wanted.
  std::vector<std::string>* passed_over = nullptr;
  /// Reading ends soon after it is cancelled, with kCancelled; null: never.
  const JobContext* job = nullptr;
};

/// Reads a mesh by its extension (.ply .obj .stl .glb) or, where that says nothing, by its first bytes.
/// Polygons are triangulated; STL, GLB and PLY with texture coordinates, which keep a vertex once per facet
/// or side of a texture seam, are welded where positions are equal. Topological faults stay (mesh_check.h);
/// that there is no face is an error. Errors name the file, the vertex or face, and the mend.
[[nodiscard]] Result<Mesh> read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {});
[[nodiscard]] Result<Mesh> read_mesh_bytes(std::string_view bytes, const std::string& name,
                                           const MeshReadOptions& options = {});

/// Whether write_mesh() knows what to write by the extension: to be asked before the work that makes the
/// mesh.
[[nodiscard]] Status check_mesh_name(const std::filesystem::path& path);

/// Writes by extension, atomically. PLY keeps everything (docs/formats/mesh.md), GLB positions, normals and
/// colours, OBJ positions, colours, normals and faces, STL the triangles alone. All say what the label does,
/// STL what 80 bytes hold of it. A name that ends in .draco.glb gives GLB compressed with Draco
/// (docs/formats/ mesh.md). Where the job is cancelled the file stays as it was (kCancelled).
[[nodiscard]] Status write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                                const FileLabel& label = {}, const JobContext* job = nullptr);

}  // namespace dubsar
