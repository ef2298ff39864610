// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/gltf_primitive.h"

#include <algorithm>
#include <string>

namespace dubsar {

namespace {

constexpr std::size_t kMaxItemsPerByte = 4;
constexpr std::size_t kMost = 0xfffffffeU;

struct Colours {
  JsonNode number;
  std::string type;  ///< RGB or RGBA
  std::size_t components;
};

std::optional<Colours> colours_of(const JsonNode& root, const JsonNode& attributes) {
  const auto number = attributes.find("COLOR_0");
  if (!number) {
    return std::nullopt;
  }
  const bool alpha = gltf_entry(root, "accessors", *number).at("type").text() == "VEC4";
  return Colours{*number, alpha ? "VEC4" : "VEC3", alpha ? std::size_t{4} : std::size_t{3}};
}

void check_colours(const JsonNode& number, std::size_t colours, std::size_t positions) {
  if (colours != positions) {
    number.complain("has not as many colours as there are positions");
  }
}

void check_room(const JsonNode& primitive, std::size_t vertices, std::size_t corners, std::size_t most) {
  if (vertices > most || corners / 3 > most) {
    primitive.complain("is repeated too often");
  } else if (corners % 3 != 0) {
    primitive.complain("has " + std::to_string(corners) + " corners, which are no whole triangles");
  }
}

std::size_t count_of(const JsonNode& accessor) {
  return static_cast<std::size_t>(accessor.at("count").integer(1, 3 * static_cast<std::int64_t>(kMost)));
}

GltfAccessor accessor_in(const char* data, std::size_t count, std::size_t stride, int component_type) {
  GltfAccessor accessor;
  accessor.data = data;
  accessor.count = count;
  accessor.stride = stride;
  accessor.component_type = component_type;
  return accessor;
}

}  // namespace

GltfReading::GltfReading(const JsonNode& document, std::string_view chunk, std::size_t file_bytes)
    : root(document),
      binary(chunk),
      most_items(std::min(kMaxItemsPerByte * file_bytes, kMost)),
      most_packed_items(std::min<std::size_t>(max_packed_items(file_bytes), kMost)),
      packed_bytes(kMaxItemsPerByte * file_bytes) {}

GltfPrimitive::GltfPrimitive(GltfReading& reading, const JsonNode& primitive, std::size_t vertices,
                             std::size_t faces) {
  const auto extensions = primitive.find("extensions");
  if (const auto draco = extensions ? extensions->find(kDracoExtension) : std::nullopt) {
    unpack(reading, primitive, *draco, vertices, faces);
    return;
  }
  find(reading, primitive);
  check_room(primitive, positions_.count + vertices, corner_count() + 3 * faces, reading.most_items);
}

void GltfPrimitive::find(const GltfReading& reading, const JsonNode& primitive) {
  const JsonNode attributes = primitive.at("attributes");
  positions_ = gltf_accessor(reading.root, attributes.at("POSITION"), reading.binary, "VEC3", 3);
  if (const auto number = primitive.find("indices")) {
    indices_ = gltf_accessor(reading.root, *number, reading.binary, "SCALAR", 1);
  }
  if (const auto colours = colours_of(reading.root, attributes)) {
    colours_ =
        gltf_accessor(reading.root, colours->number, reading.binary, colours->type, colours->components);
    check_colours(colours->number, colours_->count, positions_.count);
  }
}

/// The accessors say how many there are; the numbers are in a buffer view of the extension's.
void GltfPrimitive::unpack(GltfReading& reading, const JsonNode& primitive, const JsonNode& extension,
                           std::size_t vertices, std::size_t faces) {
  const JsonNode attributes = primitive.at("attributes");
  const JsonNode packed = extension.at("attributes");
  const auto number_of = [&](const char* name) {
    return static_cast<std::uint32_t>(packed.at(name).integer(0, static_cast<std::int64_t>(kMost)));
  };
  DracoClaim claim;
  claim.vertices = count_of(gltf_accessor_entry(reading.root, attributes.at("POSITION"), "VEC3"));
  claim.attributes.push_back(number_of("POSITION"));
  const std::size_t corners = count_of(gltf_accessor_entry(reading.root, primitive.at("indices"), "SCALAR"));
  claim.faces = corners / 3;
  const auto colours = colours_of(reading.root, attributes);
  if (colours) {
    const JsonNode accessor = gltf_accessor_entry(reading.root, colours->number, colours->type);
    check_colours(colours->number, count_of(accessor), claim.vertices);
    claim.attributes.push_back(number_of("COLOR_0"));
  }
  const std::string_view bytes = gltf_view(reading.root, extension.at("bufferView"), reading.binary);
  if (std::max(claim.vertices, claim.faces) <= max_packed_items(bytes.size())) {  // else it is told below
    check_room(primitive, claim.vertices + vertices, corners + 3 * faces, reading.most_packed_items);
  }
  if (reading.root.failed()) {
    return;
  }
  if (bytes.size() > reading.packed_bytes) {
    primitive.complain("is repeated too often");
    return;
  }
  reading.packed_bytes -= bytes.size();
  auto unpacked = decode_draco(bytes, claim);
  if (!unpacked) {
    primitive.complain(unpacked.error());
    return;
  }
  unpacked_ = std::move(*unpacked);
  const auto accessor_at = [&](std::size_t k, std::size_t components) {
    const DracoNumbers& numbers = unpacked_.numbers[k];
    if (numbers.components != components) {
      primitive.complain("holds Draco data of another kind than its accessors say");
    }
    return accessor_in(numbers.bytes.data(), claim.vertices, numbers.bytes.size() / claim.vertices,
                       numbers.component_type);
  };
  positions_ = accessor_at(0, 3);
  if (colours) {
    colours_ = accessor_at(1, colours->components);
  }
  indices_ = accessor_in(reinterpret_cast<const char*>(unpacked_.corners.data()), unpacked_.corners.size(),
                         sizeof(std::uint32_t), kGltfUnsignedInt);
}

}  // namespace dubsar
