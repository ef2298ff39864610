// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// One mesh as glTF 2.0 (ISO/IEC 12113:2022): as it is, or compressed (KHR_draco_mesh_compression).
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/srgb.h"
#include "formats/byte_order.h"
#include "formats/draco_mesh.h"
#include "formats/glb_container.h"
#include "formats/gltf_primitive.h"
#include "formats/json_text.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

constexpr int kTriangles = 4;

/// ISO/IEC 12113:2022, 5.8: copyright is text "suitable for display to credit the content creator"; what else
/// there is to say has no place of its own.
OrderedJson asset_of(const FileLabel& label) {
  OrderedJson asset{{"version", "2.0"}, {"generator", "Dubsar"}};
  if (!label.rights.empty()) {
    asset["copyright"] = label_value(label.rights);
  }
  for (const auto& [name, value] : label.words) {
    asset["extras"][label_value(name)] = label_value(value);
  }
  return asset;
}

/// As glTF asks for them (3.7.2.1), where some are not one long (another program's zero): these give way to
/// what the faces say, and where there is no face to (0, 0, 1). Empty where all are right as they are.
std::vector<Eigen::Vector3f> mended_normals(const Mesh& mesh) {
  constexpr float kLeastOff = 1e-3F;
  const auto is_unit = [](const Eigen::Vector3f& n) {
    return std::abs(n.squaredNorm() - 1.0F) < kLeastOff;  // false of what is no number, too
  };
  if (std::ranges::all_of(mesh.normals, is_unit)) {
    return {};
  }
  std::vector<Eigen::Vector3f> normals = mesh.normals;
  const std::vector<Eigen::Vector3f> of_faces = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    if (!is_unit(normals[v])) {
      normals[v] = is_unit(of_faces[v]) ? of_faces[v] : Eigen::Vector3f::UnitZ();
    }
  }
  return normals;
}

/// RGBA, linear, where a byte would lose what is dark.
std::array<std::uint16_t, 4> linear_of(const std::array<std::uint8_t, 3>& rgb) {
  const auto linear = [](std::uint8_t component) {
    return static_cast<std::uint16_t>(std::lround(65535 * linear_of_srgb(component / 255.0)));
  };
  return {linear(rgb[0]), linear(rgb[1]), linear(rgb[2]), 65535};
}

/// What a file of one mesh in one buffer is put together from.
struct Parts {
  explicit Parts(const FileLabel& label) : asset(asset_of(label)), name(label_value(label.name)) {}

  OrderedJson asset;
  std::string name;
  OrderedJson views = OrderedJson::array();
  OrderedJson accessors = OrderedJson::array();
  OrderedJson attributes;  ///< of the primitive; the last accessor is that of its indices
  OrderedJson extension;   ///< of the primitive: KHR_draco_mesh_compression, or null
  std::string binary;

  OrderedJson& add_accessor(int component_type, std::uint64_t count, const char* type,
                            std::optional<std::size_t> view) {
    OrderedJson accessor;
    if (view) {
      accessor["bufferView"] = *view;
    }
    accessor["componentType"] = component_type;
    accessor["count"] = count;
    accessor["type"] = type;
    accessors.push_back(std::move(accessor));
    return accessors.back();
  }
  void add_bounds(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    accessors.back()["min"] = json_of(Eigen::Vector3d(low.cast<double>()));
    accessors.back()["max"] = json_of(Eigen::Vector3d(high.cast<double>()));
  }
};

/// Clay is matt. A surface without a material is bare metal (3.9.6 and 5.22: metallicFactor 1), nearly black
/// where a viewer has no surroundings to mirror in it. White, so that colours of vertices are seen as they
/// are.
OrderedJson clay() {
  OrderedJson material;
  material["name"] = "clay";
  material["pbrMetallicRoughness"] = {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
  return material;
}

/// Positions are millimetres; the node scales them to metres.
std::string whole_glb(Parts parts) {
  OrderedJson primitive;
  primitive["attributes"] = std::move(parts.attributes);
  primitive["indices"] = parts.accessors.size() - 1;
  primitive["mode"] = kTriangles;
  primitive["material"] = 0;
  const bool is_packed = !parts.extension.is_null();
  if (is_packed) {
    primitive["extensions"][kDracoExtension] = std::move(parts.extension);
  }
  OrderedJson root;
  root["asset"] = std::move(parts.asset);
  if (is_packed) {
    root["extensionsUsed"] = OrderedJson::array({kDracoExtension});
    root["extensionsRequired"] = OrderedJson::array({kDracoExtension});
  }
  root["scene"] = 0;
  root["scenes"] = OrderedJson::array({{{"nodes", OrderedJson::array({0})}}});
  root["nodes"] = OrderedJson::array();
  root["nodes"].push_back({{"mesh", 0}, {"scale", OrderedJson::array({0.001, 0.001, 0.001})}});
  root["meshes"] = OrderedJson::array();
  root["meshes"].push_back({{"primitives", OrderedJson::array({std::move(primitive)})}});
  root["materials"] = OrderedJson::array({clay()});
  for (const char* named : {"nodes", "meshes"}) {
    if (!parts.name.empty()) {
      root[named][0]["name"] = parts.name;
    }
  }
  root["buffers"] = OrderedJson::array();
  root["buffers"].push_back({{"byteLength", parts.binary.size()}});
  root["bufferViews"] = std::move(parts.views);
  root["accessors"] = std::move(parts.accessors);
  return join_glb(text_of(root), std::move(parts.binary));
}

/// Whether there is room for so many bytes, beside what the file says of itself.
Status check_size(std::uint64_t bytes, const Parts& parts, const std::string& where) {
  constexpr std::uint64_t kHeaderRoom = 4096;
  // The name stands twice, and every byte of it as six at most ("\u0022").
  const std::uint64_t label_room = parts.asset.dump().size() + 12 * parts.name.size();
  return bytes + kHeaderRoom + label_room <= std::numeric_limits<std::uint32_t>::max()
             ? Status()
             : fail(ErrorKind::kUsage, "the mesh is too large for GLB (4 GiB)", where, "write .ply instead");
}

}  // namespace

Result<std::string> encode_mesh_glb(const Mesh& mesh, const std::string& where, const FileLabel& label) {
  const std::uint64_t vertices = mesh.positions.size();
  Parts parts(label);
  if (const Status fits = check_size(vertices * 32 + mesh.faces.size() * 12, parts, where); !fits) {
    return std::unexpected(fits.error());
  }
  std::string& binary = parts.binary;
  const auto begin_view = [&](std::uint64_t bytes, int target) {
    parts.views.push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}, {"target", target}});
  };
  const auto add_accessor = [&](int component_type, std::uint64_t count, const char* type) -> OrderedJson& {
    return parts.add_accessor(component_type, count, type, parts.views.size() - 1);
  };
  constexpr int kVertexTarget = 34962;
  constexpr int kIndexTarget = 34963;

  Eigen::Vector3f low = Eigen::Vector3f::Constant(vertices > 0 ? std::numeric_limits<float>::max() : 0.0F);
  Eigen::Vector3f high = -low;
  begin_view(vertices * 12, kVertexTarget);
  for (const Eigen::Vector3f& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    for (const float component : p) {
      append(binary, component);
    }
  }
  add_accessor(kGltfFloat, vertices, "VEC3");
  parts.add_bounds(low, high);
  parts.attributes["POSITION"] = 0;
  if (!mesh.normals.empty()) {
    begin_view(vertices * 12, kVertexTarget);
    const std::vector<Eigen::Vector3f> mended = mended_normals(mesh);
    for (const Eigen::Vector3f& n : mended.empty() ? mesh.normals : mended) {
      for (const float component : n) {
        append(binary, component);
      }
    }
    parts.attributes["NORMAL"] = parts.accessors.size();
    add_accessor(kGltfFloat, vertices, "VEC3");
  }
  if (!mesh.colours.empty()) {
    begin_view(vertices * 8, kVertexTarget);
    for (const auto& rgb : mesh.colours) {
      for (const std::uint16_t component : linear_of(rgb)) {
        append(binary, component);
      }
    }
    parts.attributes["COLOR_0"] = parts.accessors.size();
    add_accessor(kGltfUnsignedShort, vertices, "VEC4")["normalized"] = true;
  }
  begin_view(mesh.faces.size() * 12, kIndexTarget);
  for (const auto& face : mesh.faces) {
    for (const std::uint32_t corner : face) {
      append(binary, corner);
    }
  }
  add_accessor(kGltfUnsignedInt, 3 * mesh.faces.size(), "SCALAR");
  return whole_glb(std::move(parts));
}

Result<std::string> encode_mesh_draco_glb(const Mesh& mesh, const std::string& where,
                                          const FileLabel& label) {
  const std::vector<Eigen::Vector3f> mended = mended_normals(mesh);
  std::vector<std::array<std::uint16_t, 4>> colours(mesh.colours.size());
  std::ranges::transform(mesh.colours, colours.begin(), linear_of);
  const Result<DracoStream> packed =
      encode_draco(mesh, {.normals = mended.empty() ? mesh.normals : mended, .colours = colours}, where);
  if (!packed) {
    return std::unexpected(packed.error());
  }
  Parts parts(label);
  if (const Status fits = check_size(packed->bytes.size(), parts, where); !fits) {
    return std::unexpected(fits.error());
  }
  parts.views.push_back({{"buffer", 0}, {"byteOffset", 0}, {"byteLength", packed->bytes.size()}});
  parts.extension["bufferView"] = 0;
  const auto add = [&](const char* name, int number, int component_type, const char* type) -> OrderedJson& {
    parts.attributes[name] = parts.accessors.size();
    parts.extension["attributes"][name] = number;
    return parts.add_accessor(component_type, packed->vertices, type, std::nullopt);
  };
  add("POSITION", kDracoPosition, kGltfFloat, "VEC3");
  parts.add_bounds(packed->low, packed->high);
  if (packed->normal) {
    add("NORMAL", *packed->normal, kGltfFloat, "VEC3");
  }
  if (packed->colour) {
    add("COLOR_0", *packed->colour, kGltfUnsignedShort, "VEC4")["normalized"] = true;
  }
  parts.add_accessor(kGltfUnsignedInt, 3 * packed->faces, "SCALAR", std::nullopt);
  parts.binary = packed->bytes;
  return whole_glb(std::move(parts));
}

}  // namespace dubsar
