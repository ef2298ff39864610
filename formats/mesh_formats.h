// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "core/mesh.h"
#include "core/result.h"
#include "formats/atomic_file.h"
#include "formats/file_label.h"
#include "formats/mesh_io.h"

namespace dubsar {

enum class MeshFormat : std::uint8_t { kPly, kObj, kStl, kGlb, kDracoGlb, kUnknown };
/// By the name's ending.
[[nodiscard]] MeshFormat format_of(const std::filesystem::path& name);

/// What a producer that cannot fail writes, in one piece.
[[nodiscard]] std::string whole_text(const ByteProducer& produce);

/// Whether the work is to end; asked every few thousand lines or numbers.
[[nodiscard]] inline bool is_stopped(const JobContext* job) {
  return job != nullptr && job->cancelled();
}
/// The error of a file that was not read to its end for that.
[[nodiscard]] std::unexpected<Error> reading_stopped(const std::string& where);

// One encoder and one decoder per format, each in a file of its own (mesh_ply.cpp, mesh_obj.cpp, …). Decoders
// take no more memory than a fixed multiple of the bytes given; `where` stands in errors.

/// In pieces, so that no second copy of a large mesh is in memory. Its errors are the sink's.
[[nodiscard]] Status produce_mesh_ply(const Mesh& mesh, const ByteSink& sink, const FileLabel& label = {});
[[nodiscard]] std::string encode_mesh_ply(const Mesh& mesh, const FileLabel& label = {});
[[nodiscard]] Result<Mesh> decode_mesh_ply(std::string_view bytes, const std::string& where,
                                           const MeshReadOptions& options);

[[nodiscard]] Status produce_mesh_obj(const Mesh& mesh, const ByteSink& sink, const FileLabel& label = {});
[[nodiscard]] std::string encode_mesh_obj(const Mesh& mesh, const FileLabel& label = {});
[[nodiscard]] Result<Mesh> decode_mesh_obj(std::string_view bytes, const std::string& where,
                                           const MeshReadOptions& options);

/// Binary; at most 4 294 967 295 faces.
[[nodiscard]] std::string encode_mesh_stl(const Mesh& mesh, const FileLabel& label = {});
[[nodiscard]] Result<Mesh> decode_mesh_stl(std::string_view bytes, const std::string& where,
                                           const MeshReadOptions& options);
[[nodiscard]] bool is_binary_stl(std::string_view bytes);

/// Positions stay in millimetres to the bit; the node scales them to metres.
[[nodiscard]] Result<std::string> encode_mesh_glb(const Mesh& mesh, const std::string& where,
                                                  const FileLabel& label = {});
/// The same by KHR_draco_mesh_compression, which a reader must know then. Positions are rounded
/// (draco_step_mm), normals too; vertices that no face has and faces of fewer than three are left out.
[[nodiscard]] Result<std::string> encode_mesh_draco_glb(const Mesh& mesh, const std::string& where,
                                                        const FileLabel& label = {});
/// Both kinds.
[[nodiscard]] Result<Mesh> decode_mesh_glb(std::string_view bytes, const std::string& where,
                                           const MeshReadOptions& options);
[[nodiscard]] bool is_glb(std::string_view bytes);

/// What a mesh has no place for, as MeshReadOptions::passed_over names it.
inline constexpr const char* kTextureCoordinates = "texture coordinates";

/// A vertex in millimetres, or nothing when it is not finite.
[[nodiscard]] bool append_position(Mesh& mesh, double x_mm, double y_mm, double z_mm);

/// Adds the triangles of a polygon, convex or not; fewer than three corners add nothing.
void append_polygon(Mesh& mesh, std::span<const std::uint32_t> corners);

/// Merges vertices of equal position (the first one stays, with what is known of it). Faces that thereby have
/// a vertex twice stay, as they do where a file says so itself: the mesh check counts them. Normals go: those
/// of one side of a seam are not the vertex's.
void weld_equal_positions(Mesh& mesh);

}  // namespace dubsar
