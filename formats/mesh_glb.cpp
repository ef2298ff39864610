// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// glTF 2.0 (ISO/IEC 12113:2022) as far as a surface needs it: scenes, nodes with their transforms, triangles.
// Materials and images are passed over; colours of vertices are read. Writing: mesh_glb_writer.cpp.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/log.h"
#include "core/srgb.h"
#include "formats/bytes_left_over.h"
#include "formats/colour_values.h"
#include "formats/filed_mesh.h"
#include "formats/gltf_primitive.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

constexpr double kMmPerMetre = 1000.0;
constexpr int kTriangles = 4;
constexpr std::array<std::uint8_t, 3> kWhite{255, 255, 255};

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

/// Colours of the vertices from `first` on, which are linear there (ISO/IEC 12113:2022, 3.9.2). Vertices of
/// other primitives without colours are white.
void append_colours(GltfAccessor colours, std::size_t first, Mesh& mesh) {
  colours.normalized = true;  // whole numbers always are, here
  mesh.colours.resize(first, kWhite);
  for (std::size_t v = 0; v < colours.count; ++v) {
    mesh.colours.push_back({});
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.colours.back()[k] = colour_byte(srgb_of_linear(colours.component(v, k)));
    }
  }
}

void append_primitive(GltfReading& reading, const JsonNode& primitive, const Eigen::Affine3d& mm_from_node,
                      Mesh& mesh) {
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
  const GltfPrimitive numbers(reading, primitive, mesh.positions.size(), mesh.faces.size());
  if (reading.root.failed()) {
    return;
  }
  const GltfAccessor& positions = numbers.positions();
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
  if (numbers.colours()) {
    append_colours(*numbers.colours(), first, mesh);
  }
  const bool mirrored = mm_from_node.linear().determinant() < 0;
  for (std::size_t face = 0; face < numbers.corner_count() / 3; ++face) {
    std::array<std::uint32_t, 3> f{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double corner = numbers.corner(3 * face + k);
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

void append_scene(GltfReading& reading, double mm, const JobContext* job, Mesh& mesh) {
  const JsonNode& root = reading.root;
  const std::size_t node_count = root.at("nodes").size();
  std::vector<Placed> open;
  std::size_t reached = 0;
  // Counted here and not where they are visited: a list that names one node a million times would take its
  // memory at each visit.
  const auto reach = [&](const JsonNode& node, const Eigen::Affine3d& scene_from_parent) {
    if (++reached > node_count) {
      node.complain("is the child of more than one node");
    } else {
      open.push_back({node, scene_from_parent * transform_of(node)});
    }
  };
  const Eigen::Affine3d scaled(Eigen::Scaling(mm));
  for (const JsonNode& node : root_nodes(root)) {
    reach(node, scaled);
  }
  std::reverse(open.begin(), open.end());
  while (!open.empty() && !root.failed() && !is_stopped(job)) {
    const Placed placed = open.back();
    open.pop_back();
    if (const auto number = placed.node.find("mesh")) {
      for (const JsonNode& primitive : gltf_entry(root, "meshes", *number).at("primitives").items()) {
        append_primitive(reading, primitive, placed.scene_from_node, mesh);
        const auto attributes = primitive.find("attributes");
        reading.textured = reading.textured || (attributes && attributes->find("TEXCOORD_0"));
      }
    }
    if (const auto children = placed.node.find("children")) {
      for (const JsonNode& child : children->items()) {
        reach(gltf_entry(root, "nodes", child), placed.scene_from_node);
      }
    }
  }
}

/// Extensions of what is passed over, the one that only adds number types which are read, and the one by
/// which meshes are decompressed.
bool is_read(std::string_view extension) {
  constexpr std::array<std::string_view, 4> kOfLooks = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                        "KHR_lights_"};
  return extension == "KHR_mesh_quantization" || extension == kDracoExtension ||
         std::ranges::any_of(kOfLooks, [&](std::string_view of) { return extension.starts_with(of); });
}

void check_extensions(const JsonNode& root) {
  const auto required = root.find("extensionsRequired");
  if (!required) {
    return;
  }
  for (const JsonNode& extension : required->items()) {
    const std::string name = extension.text();
    if (name == "EXT_meshopt_compression") {
      extension.complain("is " + name + ": meshes compressed so are not read");
    } else if (!is_read(name)) {
      extension.complain("is " + name + ", which is not known");
    }
  }
}

}  // namespace

Result<Mesh> decode_mesh_glb(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  return mesh_of(decode_filed_glb(bytes, where, options));
}

Result<FiledMesh> decode_filed_glb(std::string_view bytes, const std::string& where,
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
  GltfReading reading{root, chunks->binary, bytes.size()};
  append_scene(reading, options.mm_per_unit.value_or(kMmPerMetre), options.job, mesh);
  if (is_stopped(options.job)) {
    return reading_stopped(where);
  }
  if (Status status = document->status("export the mesh again, uncompressed"); !status) {
    return std::unexpected(status.error());
  }
  if (mesh.faces.empty()) {
    return bad_input(where, "its scene holds no triangle", "export the mesh again");
  }
  if (reading.textured && options.passed_over != nullptr) {
    *options.passed_over = {kTextureCoordinates};
  }
  if (const std::string left_over = bytes_left_over(chunks->rest); !left_over.empty()) {
    log_warning(Error{ErrorKind::kBadInput, left_over, where, {}}.line());
  }
  mesh.colours.resize(mesh.colours.empty() ? 0 : mesh.positions.size(), kWhite);
  const std::size_t of_file = mesh.positions.size();
  weld_equal_positions(mesh);
  return FiledMesh{std::move(mesh), of_file};
}

}  // namespace dubsar
