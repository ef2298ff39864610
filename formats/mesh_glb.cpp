// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// glTF 2.0 (ISO/IEC 12113:2022) as far as a surface needs it: scenes, nodes with their transforms, triangles.
// Materials and images are passed over; colours of vertices are read.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/srgb.h"
#include "formats/byte_order.h"
#include "formats/colour_values.h"
#include "formats/glb_container.h"
#include "formats/json_text.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

constexpr double kMmPerMetre = 1000.0;
constexpr int kTriangles = 4;
constexpr std::array<std::uint8_t, 3> kWhite{255, 255, 255};
/// A mesh may stand in a scene several times; what comes out stays bounded by the bytes that are there.
constexpr std::size_t kMaxItemsPerByte = 4;

struct Placed {
  JsonNode node;
  Eigen::Affine3d scene_from_node;
};

Eigen::Affine3d transform_of(const JsonNode& node) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (const auto matrix = node.find("matrix")) {
    const std::vector<double> m = matrix->numbers(16);  // column major
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 3; ++r) {
        transform.matrix()(r, c) = m[static_cast<std::size_t>(4 * c + r)];
      }
    }
    return transform;
  }
  if (const auto translation = node.find("translation")) {
    transform.translate(translation->vector3());
  }
  if (const auto rotation = node.find("rotation")) {
    const std::vector<double> q = rotation->numbers(4);
    const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
    if (quaternion.norm() > 1e-9) {
      transform.rotate(quaternion.normalized());
    }
  }
  if (const auto scale = node.find("scale")) {
    transform.scale(scale->vector3());
  }
  return transform;
}

/// Colours of the vertices from `first` on, which are linear there (ISO/IEC 12113:2022, 3.9.2) and may be
/// RGB or RGBA. Vertices of other primitives without colours are white.
void append_colours(const JsonNode& root, const JsonNode& number, std::string_view binary, std::size_t first,
                    Mesh& mesh) {
  const bool has_alpha = gltf_entry(root, "accessors", number).at("type").text() == "VEC4";
  GltfAccessor colours = gltf_accessor(root, number, binary, has_alpha ? "VEC4" : "VEC3", has_alpha ? 4 : 3);
  if (root.failed()) {
    return;
  }
  if (colours.count != mesh.positions.size() - first) {
    number.complain("has not as many colours as there are positions");
    return;
  }
  colours.normalized = true;  // whole numbers always are, here
  mesh.colours.resize(first, kWhite);
  for (std::size_t v = 0; v < colours.count; ++v) {
    mesh.colours.push_back({});
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.colours.back()[k] = colour_byte(srgb_of_linear(colours.component(v, k)));
    }
  }
}

void append_primitive(const JsonNode& root, const JsonNode& primitive, std::string_view binary,
                      const Eigen::Affine3d& mm_from_node, std::size_t limit, Mesh& mesh) {
  if (const auto mode = primitive.find("mode")) {
    const std::int64_t value = mode->integer(0, 6);
    if (value < kTriangles) {
      return;  // points and lines are no surface
    }
    if (value > kTriangles) {
      mode->complain("is a strip or fan; only triangles are read");
      return;
    }
  }
  const JsonNode attributes = primitive.at("attributes");
  const GltfAccessor positions = gltf_accessor(root, attributes.at("POSITION"), binary, "VEC3", 3);
  GltfAccessor indices;
  const auto index_number = primitive.find("indices");
  if (index_number) {
    indices = gltf_accessor(root, *index_number, binary, "SCALAR", 1);
  }
  const std::size_t corners = index_number ? indices.count : positions.count;
  if (positions.count + mesh.positions.size() > limit || corners / 3 + mesh.faces.size() > limit) {
    primitive.complain("is repeated too often");
    return;
  }
  if (corners % 3 != 0) {
    primitive.complain("has " + std::to_string(corners) + " corners, which are no whole triangles");
    return;
  }
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t v = 0; v < positions.count; ++v) {
    const Eigen::Vector3d p =
        mm_from_node *
        Eigen::Vector3d(positions.component(v, 0), positions.component(v, 1), positions.component(v, 2));
    if (!append_position(mesh, p.x(), p.y(), p.z())) {
      primitive.complain("has a position that is not finite: vertex " + std::to_string(v));
      return;
    }
  }
  if (const auto colours = attributes.find("COLOR_0")) {
    append_colours(root, *colours, binary, first, mesh);
  }
  const bool mirrored = mm_from_node.linear().determinant() < 0;
  for (std::size_t face = 0; face < corners / 3; ++face) {
    std::array<std::uint32_t, 3> f{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double corner =
          index_number ? indices.component(3 * face + k, 0) : static_cast<double>(3 * face + k);
      if (!(corner >= 0 && corner < static_cast<double>(positions.count))) {
        primitive.complain("has a vertex index beyond its " + std::to_string(positions.count) +
                           " vertices: face " + std::to_string(face));
        return;
      }
      f[k] = first + static_cast<std::uint32_t>(corner);
    }
    if (mirrored) {
      std::swap(f[1], f[2]);
    }
    mesh.faces.push_back(f);
  }
}

/// The nodes of the default scene; without scenes, every node that is nobody's child.
std::vector<JsonNode> root_nodes(const JsonNode& root) {
  std::vector<JsonNode> roots;
  if (const auto scenes = root.find("scenes")) {
    const auto chosen = root.find("scene");
    const JsonNode scene = scenes->item(chosen ? static_cast<std::size_t>(chosen->integer(0, 1 << 20)) : 0);
    if (const auto nodes = scene.find("nodes")) {
      for (const JsonNode& number : nodes->items()) {
        roots.push_back(gltf_entry(root, "nodes", number));
      }
    }
    return roots;
  }
  const std::vector<JsonNode> nodes = root.at("nodes").items();
  std::vector<bool> is_child(nodes.size(), false);
  for (const JsonNode& node : nodes) {
    if (const auto children = node.find("children")) {
      for (const JsonNode& child : children->items()) {
        const auto index = static_cast<std::size_t>(child.integer(0, std::int64_t{1} << 31U));
        if (index < is_child.size()) {
          is_child[index] = true;
        }
      }
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!is_child[i]) {
      roots.push_back(nodes[i]);
    }
  }
  return roots;
}

void append_scene(const JsonNode& root, std::string_view binary, double mm, std::size_t limit, Mesh& mesh) {
  const std::size_t node_count = root.at("nodes").size();
  std::vector<Placed> open;
  const Eigen::Affine3d scaled(Eigen::Scaling(mm));
  for (const JsonNode& node : root_nodes(root)) {
    open.push_back({node, scaled * transform_of(node)});
  }
  std::reverse(open.begin(), open.end());
  std::size_t visited = 0;
  while (!open.empty() && !root.failed()) {
    const Placed placed = open.back();
    open.pop_back();
    if (++visited > node_count) {
      placed.node.complain("is the child of more than one node");
      return;
    }
    if (const auto number = placed.node.find("mesh")) {
      for (const JsonNode& primitive : gltf_entry(root, "meshes", *number).at("primitives").items()) {
        append_primitive(root, primitive, binary, placed.scene_from_node, limit, mesh);
      }
    }
    if (const auto children = placed.node.find("children")) {
      for (const JsonNode& child : children->items()) {
        const JsonNode node = gltf_entry(root, "nodes", child);
        open.push_back({node, placed.scene_from_node * transform_of(node)});
      }
    }
  }
}

/// Extensions of what is passed over, and the one that only adds number types which are read.
bool leaves_the_surface(std::string_view extension) {
  constexpr std::array<std::string_view, 4> kOfLooks = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                        "KHR_lights_"};
  return extension == "KHR_mesh_quantization" ||
         std::ranges::any_of(kOfLooks, [&](std::string_view of) { return extension.starts_with(of); });
}

void check_extensions(const JsonNode& root) {
  const auto required = root.find("extensionsRequired");
  if (!required) {
    return;
  }
  for (const JsonNode& extension : required->items()) {
    const std::string name = extension.text();
    if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
      extension.complain("is " + name + ": compressed meshes are not read");
    } else if (!leaves_the_surface(name)) {
      extension.complain("is " + name + ", which is not known");
    }
  }
}

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

}  // namespace

Result<Mesh> decode_mesh_glb(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  const Result<GlbChunks> chunks = split_glb(bytes, where);
  if (!chunks) {
    return std::unexpected(chunks.error());
  }
  const Result<JsonDocument> document = JsonDocument::parse(chunks->json, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  check_extensions(root);
  Mesh mesh;
  const std::size_t limit = std::min<std::size_t>(kMaxItemsPerByte * bytes.size(), 0xfffffffeU);
  append_scene(root, chunks->binary, options.mm_per_unit.value_or(kMmPerMetre), limit, mesh);
  if (Status status = document->status("export the mesh again, uncompressed"); !status) {
    return std::unexpected(status.error());
  }
  if (mesh.faces.empty()) {
    return bad_input(where, "its scene holds no triangle", "export the mesh again");
  }
  mesh.colours.resize(mesh.colours.empty() ? 0 : mesh.positions.size(), kWhite);
  weld_equal_positions(mesh);
  return mesh;
}

Result<std::string> encode_mesh_glb(const Mesh& mesh, const std::string& where, const FileLabel& label) {
  const std::uint64_t vertices = mesh.positions.size();
  constexpr std::uint64_t kHeaderRoom = 4096;
  const OrderedJson asset = asset_of(label);
  const std::string name = label_value(label.name);
  // The name stands twice, and every byte of it as six at most ("\u0022").
  const std::uint64_t label_room = asset.dump().size() + 12 * name.size();
  if (vertices * 32 + mesh.faces.size() * 12 + kHeaderRoom + label_room >
      std::numeric_limits<std::uint32_t>::max()) {
    return fail(ErrorKind::kUsage, "the mesh is too large for GLB (4 GiB)", where, "write .ply instead");
  }
  std::string binary;
  OrderedJson views = OrderedJson::array();
  OrderedJson accessors = OrderedJson::array();
  const auto begin_view = [&](std::uint64_t bytes, int target) {
    views.push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes}, {"target", target}});
  };
  const auto add_accessor = [&](int component_type, std::uint64_t count, const char* type) {
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", component_type},
                         {"count", count},
                         {"type", type}});
  };
  constexpr int kVertexTarget = 34962;
  constexpr int kIndexTarget = 34963;
  OrderedJson attributes;

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
  accessors.back()["min"] = json_of(Eigen::Vector3d(low.cast<double>()));
  accessors.back()["max"] = json_of(Eigen::Vector3d(high.cast<double>()));
  attributes["POSITION"] = 0;
  if (!mesh.normals.empty()) {
    begin_view(vertices * 12, kVertexTarget);
    const std::vector<Eigen::Vector3f> mended = mended_normals(mesh);
    for (const Eigen::Vector3f& n : mended.empty() ? mesh.normals : mended) {
      for (const float component : n) {
        append(binary, component);
      }
    }
    attributes["NORMAL"] = accessors.size();
    add_accessor(kGltfFloat, vertices, "VEC3");
  }
  if (!mesh.colours.empty()) {
    // Linear, where a byte would lose what is dark.
    begin_view(vertices * 8, kVertexTarget);
    for (const auto& rgb : mesh.colours) {
      for (const std::uint8_t component : rgb) {
        append(binary, static_cast<std::uint16_t>(std::lround(65535 * linear_of_srgb(component / 255.0))));
      }
      append(binary, std::uint16_t{65535});
    }
    attributes["COLOR_0"] = accessors.size();
    add_accessor(kGltfUnsignedShort, vertices, "VEC4");
    accessors.back()["normalized"] = true;
  }
  begin_view(mesh.faces.size() * 12, kIndexTarget);
  for (const auto& face : mesh.faces) {
    for (const std::uint32_t corner : face) {
      append(binary, corner);
    }
  }
  add_accessor(kGltfUnsignedInt, 3 * mesh.faces.size(), "SCALAR");

  OrderedJson primitive;
  primitive["attributes"] = std::move(attributes);
  primitive["indices"] = accessors.size() - 1;
  primitive["mode"] = kTriangles;
  OrderedJson root;
  root["asset"] = asset;
  root["scene"] = 0;
  root["scenes"] = OrderedJson::array({{{"nodes", OrderedJson::array({0})}}});
  root["nodes"] = OrderedJson::array();
  root["nodes"].push_back({{"mesh", 0}, {"scale", OrderedJson::array({0.001, 0.001, 0.001})}});
  root["meshes"] = OrderedJson::array();
  root["meshes"].push_back({{"primitives", OrderedJson::array({std::move(primitive)})}});
  for (const char* named : {"nodes", "meshes"}) {
    if (!name.empty()) {
      root[named][0]["name"] = name;
    }
  }
  root["buffers"] = OrderedJson::array();
  root["buffers"].push_back({{"byteLength", binary.size()}});
  root["bufferViews"] = std::move(views);
  root["accessors"] = std::move(accessors);
  return join_glb(text_of(root), std::move(binary));
}

}  // namespace dubsar
