// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <cmath>

#include "formats/byte_order.h"
#include "formats/mesh_formats.h"
#include "formats/number_text.h"
#include "formats/ply_body.h"
#include "formats/ply_scan.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export the mesh again";

/// Where the vertex properties stand; -1 for those that are absent.
struct Columns {
  std::array<int, 3> position, normal, colour;
  int reliability, sigma, scans, flags;
  double colour_scale = 1;

  explicit Columns(const PlyElement& vertex)
      : position{vertex.scalar("x"), vertex.scalar("y"), vertex.scalar("z")},
        normal{vertex.scalar("nx"), vertex.scalar("ny"), vertex.scalar("nz")},
        colour{vertex.scalar("red"), vertex.scalar("green"), vertex.scalar("blue")},
        reliability(vertex.scalar("reliability")),
        sigma(vertex.scalar("sigma")),
        scans(vertex.scalar("scans")),
        flags(vertex.scalar("flags")) {
    if (has(colour) && vertex.properties[static_cast<std::size_t>(colour[0])].type >= PlyType::kFloat32) {
      colour_scale = 255;
    }
  }
  [[nodiscard]] static bool has(const std::array<int, 3>& three) {
    return std::all_of(three.begin(), three.end(), [](int p) { return p >= 0; });
  }
};

/// NaN and what lies outside become the nearest byte.
std::uint8_t byte_of(double value) {
  return value > 0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : std::uint8_t{0};
}

Status read_vertices(PlyBody& body, const PlyElement& vertex, double mm, const std::string& where,
                     Mesh& mesh) {
  const Columns columns(vertex);
  if (!Columns::has(columns.position)) {
    return bad_input(where, "its vertices lack x, y or z", kExportAgain);
  }
  if (Status claim = body.check_claim(vertex); !claim) {
    return claim;
  }
  mesh.positions.reserve(static_cast<std::size_t>(vertex.count));
  return body.read(vertex, [&](std::uint64_t index, const PlyRow& row) -> Status {
    if (!append_position(mesh, mm * row.value(columns.position[0]), mm * row.value(columns.position[1]),
                         mm * row.value(columns.position[2]))) {
      return body.error_at(vertex, index, "its position is not finite", kExportAgain);
    }
    if (Columns::has(columns.normal)) {
      const Eigen::Vector3f n(static_cast<float>(row.value(columns.normal[0])),
                              static_cast<float>(row.value(columns.normal[1])),
                              static_cast<float>(row.value(columns.normal[2])));
      mesh.normals.push_back(n.allFinite() ? n : Eigen::Vector3f::Zero());
    }
    if (columns.reliability >= 0) {
      const double reliability = row.value(columns.reliability);
      mesh.reliability.push_back(reliability > 0 ? static_cast<float>(std::min(reliability, 1.0)) : 0.0F);
    }
    if (columns.sigma >= 0) {
      const double sigma = mm * row.value(columns.sigma);
      mesh.sigma_mm.push_back(sigma > 0 && std::isfinite(sigma) ? static_cast<float>(sigma) : 0.0F);
    }
    if (columns.scans >= 0) {
      mesh.scans.push_back(byte_of(row.value(columns.scans)));
    }
    if (columns.flags >= 0) {
      mesh.flags.push_back(byte_of(row.value(columns.flags)));
    }
    if (Columns::has(columns.colour)) {
      std::array<std::uint8_t, 3> rgb{};
      for (std::size_t k = 0; k < 3; ++k) {
        rgb[k] = byte_of(columns.colour_scale * row.value(columns.colour[k]));
      }
      mesh.colours.push_back(rgb);
    }
    return {};
  });
}

Status read_faces(PlyBody& body, const PlyElement& face, std::uint64_t vertices, const std::string& where,
                  Mesh& mesh) {
  int list = -1;
  for (std::size_t p = 0; p < face.properties.size(); ++p) {
    const std::string& name = face.properties[p].name;
    if (face.properties[p].count_type && (name == "vertex_indices" || name == "vertex_index")) {
      list = static_cast<int>(p);
    }
  }
  if (list < 0 && face.count > 0) {
    return bad_input(where, "its faces have no list vertex_indices", kExportAgain);
  }
  std::vector<std::uint32_t> corners;
  return body.read(face, [&](std::uint64_t index, const PlyRow& row) -> Status {
    corners.clear();
    for (const double corner : row.lists[static_cast<std::size_t>(list)]) {
      if (!(corner >= 0 && corner < static_cast<double>(vertices) && corner == std::floor(corner))) {
        return body.error_at(face, index,
                             "vertex index " + number_text(corner) + " is not one of the " +
                                 std::to_string(vertices) + " vertices",
                             kExportAgain);
      }
      corners.push_back(static_cast<std::uint32_t>(corner));
    }
    append_polygon(mesh, corners);
    return {};
  });
}

}  // namespace

Result<Mesh> decode_mesh_ply(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  const Result<PlyHeader> header = parse_ply_header(bytes, where);
  if (!header) {
    return std::unexpected(header.error());
  }
  const PlyElement* vertex = header->element("vertex");
  if (vertex == nullptr || header->element("face") == nullptr) {
    return bad_input(where, vertex == nullptr ? "a PLY file without vertices" : "a PLY file without faces",
                     "give a mesh; scans become one with dubsar stitch");
  }
  const Result<double> said = mm_per_unit_of(*header, where);
  if (!said && !options.mm_per_unit) {
    return std::unexpected(said.error());
  }
  const double mm = options.mm_per_unit ? *options.mm_per_unit : *said;
  PlyBody body(*header, bytes, where);
  Mesh mesh;
  for (const PlyElement& element : header->elements) {
    Status status;
    if (element.name == "vertex") {
      status = read_vertices(body, element, mm, where, mesh);
    } else if (element.name == "face") {
      status = read_faces(body, element, std::min<std::uint64_t>(vertex->count, 0xffffffffU), where, mesh);
    } else {
      status = body.skip(element);
    }
    if (!status) {
      return std::unexpected(status.error());
    }
  }
  return mesh;
}

Status produce_mesh_ply(const Mesh& mesh, const ByteSink& sink) {
  constexpr std::size_t kPiece = std::size_t{1} << 20U;
  const std::size_t vertices = mesh.positions.size();
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment Mesh of Dubsar\nobj_info unit mm\nelement vertex " +
      std::to_string(vertices) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "reliability"}) {
    out += std::string("property float ") + name + "\n";
  }
  out += "property uchar scans\nproperty uchar flags\n";
  if (!mesh.sigma_mm.empty()) {
    out += "property float sigma\n";
  }
  if (!mesh.colours.empty()) {
    out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  out += "element face " + std::to_string(mesh.faces.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto pass_on = [&](std::size_t least) -> Status {
    if (out.size() < least) {
      return {};
    }
    const Status taken = sink(std::as_bytes(std::span(out)));
    out.clear();
    return taken;
  };
  const std::vector<Eigen::Vector3f> computed =
      mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Eigen::Vector3f>{};
  const std::vector<Eigen::Vector3f>& normals = mesh.normals.empty() ? computed : mesh.normals;
  for (std::size_t v = 0; v < vertices; ++v) {
    for (const Eigen::Vector3f& three : {mesh.positions[v], normals[v]}) {
      append(out, three.x());
      append(out, three.y());
      append(out, three.z());
    }
    append(out, mesh.reliability.empty() ? 1.0F : mesh.reliability[v]);
    append(out, mesh.scans.empty() ? std::uint8_t{0} : mesh.scans[v]);
    append(out, mesh.flags.empty() ? std::uint8_t{0} : mesh.flags[v]);
    if (!mesh.sigma_mm.empty()) {
      append(out, mesh.sigma_mm[v]);
    }
    for (std::size_t k = 0; k < 3 && !mesh.colours.empty(); ++k) {
      append(out, mesh.colours[v][k]);
    }
    if (const Status passed = pass_on(kPiece); !passed) {
      return passed;
    }
  }
  for (const auto& face : mesh.faces) {
    append(out, std::uint8_t{3});
    for (const std::uint32_t corner : face) {
      append(out, corner);
    }
    if (const Status passed = pass_on(kPiece); !passed) {
      return passed;
    }
  }
  return pass_on(1);
}

std::string encode_mesh_ply(const Mesh& mesh) {
  std::string out;
  (void)produce_mesh_ply(mesh, [&](std::span<const std::byte> bytes) -> Status {
    out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  });
  return out;
}

}  // namespace dubsar
