// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/mesh_io.h"

#include <algorithm>

#include "formats/atomic_file.h"
#include "formats/filed_mesh.h"
#include "formats/mesh_formats.h"
#include "formats/place_precision.h"
#include "formats/ply_header.h"

namespace dubsar {

namespace {

constexpr const char* kKnown = "use .ply, .obj, .stl or .glb";

std::string small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
  });
  return text;
}

}  // namespace

MeshFormat format_of(const std::filesystem::path& name) {
  const std::string extension = small_letters(name.extension().string());
  if (extension == ".ply") {
    return MeshFormat::kPly;
  }
  if (extension == ".obj") {
    return MeshFormat::kObj;
  }
  if (extension == ".stl") {
    return MeshFormat::kStl;
  }
  if (extension == ".glb") {
    return small_letters(name.stem().extension().string()) == ".draco" ? MeshFormat::kDracoGlb
                                                                       : MeshFormat::kGlb;
  }
  return MeshFormat::kUnknown;
}

namespace {

/// The bytes decide where they can.
MeshFormat format_of_bytes(std::string_view bytes, const std::filesystem::path& name) {
  if (is_ply(bytes)) {
    return MeshFormat::kPly;
  }
  if (is_glb(bytes)) {
    return MeshFormat::kGlb;
  }
  const MeshFormat named = format_of(name);
  return named == MeshFormat::kUnknown && is_binary_stl(bytes) ? MeshFormat::kStl : named;
}

Result<FiledMesh> decode(std::string_view bytes, const std::string& name, const MeshReadOptions& options) {
  switch (format_of_bytes(bytes, name)) {
    case MeshFormat::kPly:
      return decode_filed_ply(bytes, name, options);
    case MeshFormat::kObj: {
      Result<Mesh> mesh = decode_mesh_obj(bytes, name, options);
      if (!mesh) {
        return std::unexpected(mesh.error());
      }
      const std::size_t count = mesh->positions.size();
      return FiledMesh{*std::move(mesh), count};
    }
    case MeshFormat::kStl:
      return decode_filed_stl(bytes, name, options);
    case MeshFormat::kGlb:
    case MeshFormat::kDracoGlb:
      return decode_filed_glb(bytes, name, options);
    case MeshFormat::kUnknown:
      break;
  }
  return bad_input(name, "not a mesh that Dubsar reads", kKnown);
}

/// Passes on until the job is cancelled.
ByteSink stoppable(const ByteSink& sink, const std::filesystem::path& path, const JobContext* job) {
  return [&sink, &path, job](std::span<const std::byte> bytes) -> Status {
    if (is_stopped(job)) {
      return fail(ErrorKind::kCancelled, "writing was stopped", path.string());
    }
    return sink(bytes);
  };
}

Status write_in_pieces(const std::filesystem::path& path, std::string_view text, const JobContext* job) {
  constexpr std::size_t kPiece = std::size_t{1} << 20U;
  return write_file_atomically(path, [&](const ByteSink& sink) -> Status {
    Status passed;
    const ByteSink into = stoppable(sink, path, job);
    for (std::size_t at = 0; passed && at < text.size(); at += kPiece) {
      passed = into(std::as_bytes(std::span(text.substr(at, kPiece))));
    }
    return passed;
  });
}

}  // namespace

Result<Mesh> read_mesh_bytes(std::string_view bytes, const std::string& name,
                             const MeshReadOptions& options) {
  return mesh_of(read_filed_mesh_bytes(bytes, name, options));
}

Result<FiledMesh> read_filed_mesh_bytes(std::string_view bytes, const std::string& name,
                                        const MeshReadOptions& options) {
  if (bytes.empty()) {
    return bad_input(name, "the file is empty", "copy or export it again");
  }
  Result<FiledMesh> read = decode(bytes, name, options);
  if (is_stopped(options.job)) {
    return reading_stopped(name);
  }
  const bool only_points = read && read->mesh.faces.empty() && options.may_be_points;
  if (read && !only_points) {
    if (const Status precise = check_precision(read->mesh, name); !precise) {
      return std::unexpected(precise.error());
    }
  }
  return read;
}

Result<Mesh> read_mesh(const std::filesystem::path& path, const MeshReadOptions& options) {
  const Result<std::string> bytes = read_whole_file(path);
  return bytes ? read_mesh_bytes(*bytes, path.string(), options) : std::unexpected(bytes.error());
}

Status check_mesh_name(const std::filesystem::path& path) {
  return format_of(path) != MeshFormat::kUnknown
             ? Status()
             : fail(ErrorKind::kUsage, "cannot tell the mesh format from the name", path.string(), kKnown);
}

Status write_mesh(const std::filesystem::path& path, const Mesh& mesh, const FileLabel& label,
                  const JobContext* job) {
  switch (format_of(path)) {
    case MeshFormat::kPly:
      return write_file_atomically(path, [&](const ByteSink& sink) {
        return produce_mesh_ply(mesh, stoppable(sink, path, job), label);
      });
    case MeshFormat::kObj:
      return write_file_atomically(path, [&](const ByteSink& sink) {
        return produce_mesh_obj(mesh, stoppable(sink, path, job), label);
      });
    case MeshFormat::kStl:
      return write_in_pieces(path, encode_mesh_stl(mesh, label), job);
    case MeshFormat::kGlb: {
      const Result<std::string> bytes = encode_mesh_glb(mesh, path.string(), label);
      return bytes ? write_in_pieces(path, *bytes, job) : std::unexpected(bytes.error());
    }
    case MeshFormat::kDracoGlb: {
      if (is_stopped(job)) {  // it cannot be while it is compressed
        return fail(ErrorKind::kCancelled, "writing was stopped", path.string());
      }
      const Result<std::string> bytes = encode_mesh_draco_glb(mesh, path.string(), label);
      return bytes ? write_in_pieces(path, *bytes, job) : std::unexpected(bytes.error());
    }
    case MeshFormat::kUnknown:
      break;
  }
  return check_mesh_name(path);
}

}  // namespace dubsar
