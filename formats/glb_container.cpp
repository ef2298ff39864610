// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/glb_container.h"

#include <algorithm>

#include "formats/byte_order.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr std::uint32_t kMagic = 0x46546c67U;
constexpr std::uint32_t kJsonChunk = 0x4e4f534aU;
constexpr std::uint32_t kBinaryChunk = 0x004e4942U;
constexpr const char* kCutShort = "the file is cut short or damaged: copy or export it again";

std::size_t component_bytes(std::int64_t type) {
  switch (type) {
    case kGltfByte:
    case kGltfUnsignedByte:
      return 1;
    case kGltfShort:
    case kGltfUnsignedShort:
      return 2;
    case kGltfUnsignedInt:
    case kGltfFloat:
      return 4;
    default:
      return 0;
  }
}

std::uint64_t size_at(const JsonNode& node, const char* key, std::uint64_t otherwise) {
  const auto value = node.find(key);
  return value ? static_cast<std::uint64_t>(value->integer(0, std::int64_t{1} << 40U)) : otherwise;
}

}  // namespace

bool is_glb(std::string_view bytes) {
  return bytes.starts_with("glTF");
}

Result<GlbChunks> split_glb(std::string_view bytes, const std::string& where) {
  if (!is_glb(bytes)) {
    return bad_input(where, "not a GLB file (it does not begin with 'glTF')", "check what the file is");
  }
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
    return bad_input(where, "ends within its GLB header", kCutShort);
  }
  const auto version = load<std::uint32_t>(bytes.data() + 4);
  if (version != 2) {
    return bad_input(where, "glTF version " + std::to_string(version) + " is not read",
                     "export it as glTF 2.0");
  }
  const std::uint64_t length = load<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size()) {
    return bad_input(where,
                     "claims " + std::to_string(length) + " bytes, but holds " + std::to_string(bytes.size()),
                     kCutShort);
  }
  GlbChunks chunks;
  std::size_t at = kHeaderBytes;
  for (int chunk = 0; at + kChunkHeaderBytes <= bytes.size(); ++chunk) {
    const std::uint64_t size = load<std::uint32_t>(bytes.data() + at);
    const auto type = load<std::uint32_t>(bytes.data() + at + 4);
    const bool fits = size <= bytes.size() - at - kChunkHeaderBytes;
    if (at >= length && (chunk > 1 || !fits)) {
      break;  // none of the file's; a length that is too small hides none of the two that are read
    }
    at += kChunkHeaderBytes;
    if (!fits) {
      return bad_input(where, "chunk " + std::to_string(chunk) + " claims more bytes than are left",
                       kCutShort);
    }
    if (chunk == 0 && type == kJsonChunk) {
      chunks.json = bytes.substr(at, size);
    } else if (type == kBinaryChunk && chunks.binary.empty()) {
      chunks.binary = bytes.substr(at, size);
    }
    at += size;
  }
  if (chunks.json.empty()) {
    return bad_input(where, "its first chunk is not JSON", kCutShort);
  }
  chunks.rest = bytes.substr(std::max<std::size_t>(at, length));
  return chunks;
}

std::string join_glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out;
  out.reserve(kHeaderBytes + 2 * kChunkHeaderBytes + json.size() + binary.size());
  append(out, kMagic);
  append(out, std::uint32_t{2});
  append(out, static_cast<std::uint32_t>(kHeaderBytes + 2 * kChunkHeaderBytes + json.size() + binary.size()));
  append(out, static_cast<std::uint32_t>(json.size()));
  append(out, kJsonChunk);
  out += json;
  append(out, static_cast<std::uint32_t>(binary.size()));
  append(out, kBinaryChunk);
  out += binary;
  return out;
}

double GltfAccessor::component(std::size_t index, std::size_t k) const {
  const char* at = data + index * stride + k * component_bytes(component_type);
  switch (component_type) {
    case kGltfByte:
      return normalized ? std::max(load<std::int8_t>(at) / 127.0, -1.0) : load<std::int8_t>(at);
    case kGltfUnsignedByte:
      return normalized ? load<std::uint8_t>(at) / 255.0 : load<std::uint8_t>(at);
    case kGltfShort:
      return normalized ? std::max(load<std::int16_t>(at) / 32767.0, -1.0) : load<std::int16_t>(at);
    case kGltfUnsignedShort:
      return normalized ? load<std::uint16_t>(at) / 65535.0 : load<std::uint16_t>(at);
    case kGltfUnsignedInt:
      return load<std::uint32_t>(at);
    default:
      return static_cast<double>(load<float>(at));
  }
}

JsonNode gltf_entry(const JsonNode& root, const char* array, const JsonNode& number) {
  const JsonNode list = root.at(array);
  return list.item(static_cast<std::size_t>(number.integer(0, std::int64_t{1} << 31U)));
}

std::string_view gltf_view(const JsonNode& root, const JsonNode& number, std::string_view binary) {
  const JsonNode view = gltf_entry(root, "bufferViews", number);
  const JsonNode buffer = gltf_entry(root, "buffers", view.at("buffer"));
  if (buffer.find("uri") || view.at("buffer").integer(0, std::int64_t{1} << 31U) != 0) {
    buffer.complain("lies outside of the file, which is not read");
  }
  const std::uint64_t offset = size_at(view, "byteOffset", 0);
  const std::uint64_t bytes = size_at(view, "byteLength", 0);
  if (bytes > binary.size() || offset > binary.size() - bytes) {
    view.complain("reaches beyond the " + std::to_string(binary.size()) + " bytes of the binary chunk");
    return {};
  }
  return binary.substr(offset, bytes);
}

JsonNode gltf_accessor_entry(const JsonNode& root, const JsonNode& number, std::string_view type) {
  const JsonNode node = gltf_entry(root, "accessors", number);
  if (node.find("sparse")) {
    node.complain("is sparse, which is not read");
  }
  if (node.at("type").text() != type) {
    node.at("type").complain("is not " + std::string(type));
  }
  return node;
}

GltfAccessor gltf_accessor(const JsonNode& root, const JsonNode& number, std::string_view binary,
                           std::string_view type, std::size_t components) {
  const JsonNode node = gltf_accessor_entry(root, number, type);
  GltfAccessor accessor;
  const std::int64_t component_type = node.at("componentType").integer(0, 0xffff);
  const std::size_t item_bytes = components * component_bytes(component_type);
  if (item_bytes == 0) {
    node.at("componentType").complain("is no component type of glTF");
    return {};
  }
  const JsonNode view_number = node.at("bufferView");
  const std::string_view view = gltf_view(root, view_number, binary);
  const std::uint64_t offset = size_at(node, "byteOffset", 0);
  const std::uint64_t count = size_at(node, "count", 0);
  const std::uint64_t stride =
      size_at(gltf_entry(root, "bufferViews", view_number), "byteStride", item_bytes);
  if (stride < item_bytes || stride > 252 || count == 0 || count > binary.size() ||
      offset + (count - 1) * stride + item_bytes > view.size()) {
    node.complain("does not fit into its buffer view");
    return {};
  }
  accessor.data = view.data() + offset;
  accessor.count = static_cast<std::size_t>(count);
  accessor.stride = static_cast<std::size_t>(stride);
  accessor.component_type = static_cast<int>(component_type);
  if (const auto normalized = node.find("normalized")) {
    accessor.normalized = normalized->boolean();
  }
  return accessor;
}

}  // namespace dubsar
