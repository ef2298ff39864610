// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "formats/draco_mesh.h"
#include "formats/glb_container.h"

namespace dubsar {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

/// What all primitives of a file are read from. A mesh may stand in a scene several times: what comes out of
/// the file stays bounded by its bytes.
struct GltfReading {
  GltfReading(const JsonNode& document, std::string_view chunk, std::size_t file_bytes);

  const JsonNode& root;
  std::string_view binary;
  std::size_t most_items;         ///< vertices, and faces
  std::size_t most_packed_items;  ///< the same, where a primitive is compressed
  std::size_t packed_bytes;       ///< that may still be decompressed
  bool textured = false;          ///< a primitive has texture coordinates
};

/// The numbers of one primitive of triangles, in the binary chunk or decompressed.
class GltfPrimitive {
 public:
  /// Complaints go to the document, and what is here means nothing then. `vertices` and `faces`: of the
  /// primitives before it.
  GltfPrimitive(GltfReading& reading, const JsonNode& primitive, std::size_t vertices, std::size_t faces);
  GltfPrimitive(const GltfPrimitive&) = delete;
  GltfPrimitive& operator=(const GltfPrimitive&) = delete;

  [[nodiscard]] const GltfAccessor& positions() const { return positions_; }
  [[nodiscard]] const std::optional<GltfAccessor>& colours() const { return colours_; }  ///< as many
  [[nodiscard]] std::size_t corner_count() const { return indices_ ? indices_->count : positions_.count; }
  /// The vertex there, which may lie beyond the last.
  [[nodiscard]] double corner(std::size_t k) const {
    return indices_ ? indices_->component(k, 0) : static_cast<double>(k);
  }

 private:
  void find(const GltfReading& reading, const JsonNode& primitive);
  void unpack(GltfReading& reading, const JsonNode& primitive, const JsonNode& extension,
              std::size_t vertices, std::size_t faces);

  GltfAccessor positions_;
  std::optional<GltfAccessor> indices_, colours_;
  DracoMesh unpacked_;  ///< what the others point into then
};

}  // namespace dubsar
