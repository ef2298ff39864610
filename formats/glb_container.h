// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/json_node.h"

namespace dubsar {

/// The two chunks of a binary glTF 2.0 file (ISO/IEC 12113:2022, 4.4).
struct GlbChunks {
  std::string_view json;
  std::string_view binary;  ///< empty when there is none
  std::string_view rest;    ///< what follows the length that the header says
};

[[nodiscard]] Result<GlbChunks> split_glb(std::string_view bytes, const std::string& where);
[[nodiscard]] std::string join_glb(std::string json, std::string binary);

/// Component types of accessors.
inline constexpr int kGltfByte = 5120;
inline constexpr int kGltfUnsignedByte = 5121;
inline constexpr int kGltfShort = 5122;
inline constexpr int kGltfUnsignedShort = 5123;
inline constexpr int kGltfUnsignedInt = 5125;
inline constexpr int kGltfFloat = 5126;

/// Numbers that lie in the binary chunk; every read within `count` lies within the chunk.
struct GltfAccessor {
  const char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  int component_type = kGltfFloat;
  bool normalized = false;

  [[nodiscard]] double component(std::size_t index, std::size_t k) const;
};

/// The accessor of that number with `components` numbers an entry, checked against the chunk. Complaints go
/// to the document; the accessor is then empty.
[[nodiscard]] GltfAccessor gltf_accessor(const JsonNode& root, const JsonNode& number,
                                         std::string_view binary, std::string_view type,
                                         std::size_t components);

/// The accessor's own entry, where it is not sparse and of that type.
[[nodiscard]] JsonNode gltf_accessor_entry(const JsonNode& root, const JsonNode& number,
                                           std::string_view type);

/// The bytes of the buffer view of that number, within the chunk; empty after a complaint.
[[nodiscard]] std::string_view gltf_view(const JsonNode& root, const JsonNode& number,
                                         std::string_view binary);

/// The entry of a top-level array that `number` refers to.
[[nodiscard]] JsonNode gltf_entry(const JsonNode& root, const char* array, const JsonNode& number);

}  // namespace dubsar
