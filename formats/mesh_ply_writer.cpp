// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/byte_order.h"
#include "formats/mesh_formats.h"
#include "formats/ply_of_unknown_unit.h"

namespace dubsar {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20U;

/// What is not known of the vertices has no property: a number in its place would be taken for a measure.
std::string header_of(const Mesh& mesh, const FileLabel& label, bool unit_known) {
  std::string out = "ply\nformat binary_little_endian 1.0\n" + mesh_line(label, "comment ") +
                    label_lines(label, "comment ") + (unit_known ? "obj_info unit mm\n" : "") +
                    "element vertex " + std::to_string(mesh.positions.size()) + "\n";
  const auto property = [&](bool known, const char* type_and_name) {
    if (known) {
      out.append("property ").append(type_and_name).push_back('\n');
    }
  };
  for (const char* number : {"float x", "float y", "float z", "float nx", "float ny", "float nz"}) {
    property(true, number);
  }
  property(!mesh.reliability.empty(), "float reliability");
  property(!mesh.scans.empty(), "uchar scans");
  property(!mesh.flags.empty(), "uchar flags");
  property(!mesh.sigma_mm.empty(), "float sigma");
  for (const char* colour : {"uchar red", "uchar green", "uchar blue"}) {
    property(!mesh.colours.empty(), colour);
  }
  return out + "element face " + std::to_string(mesh.faces.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

Status produce_ply(const Mesh& mesh, const ByteSink& sink, const FileLabel& label, bool unit_known) {
  std::string out = header_of(mesh, label, unit_known);
  const auto pass_on = [&](std::size_t least) -> Status {
    if (out.size() < least) {
      return {};
    }
    const Status taken = sink(std::as_bytes(std::span(out)));
    out.clear();
    return taken;
  };
  const auto append_where_known = [&](const auto& of_vertices, std::size_t v) {
    if (!of_vertices.empty()) {
      append(out, of_vertices[v]);
    }
  };
  const std::vector<Eigen::Vector3f> computed =
      mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Eigen::Vector3f>{};
  const std::vector<Eigen::Vector3f>& normals = mesh.normals.empty() ? computed : mesh.normals;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const Eigen::Vector3f& three : {mesh.positions[v], normals[v]}) {
      append(out, three.x());
      append(out, three.y());
      append(out, three.z());
    }
    append_where_known(mesh.reliability, v);
    append_where_known(mesh.scans, v);
    append_where_known(mesh.flags, v);
    append_where_known(mesh.sigma_mm, v);
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

}  // namespace

Status produce_mesh_ply(const Mesh& mesh, const ByteSink& sink, const FileLabel& label) {
  return produce_ply(mesh, sink, label, true);
}

Status write_ply_of_unknown_unit(const std::filesystem::path& path, const Mesh& mesh,
                                 const FileLabel& label) {
  return write_file_atomically(path,
                               [&](const ByteSink& sink) { return produce_ply(mesh, sink, label, false); });
}

std::string encode_mesh_ply(const Mesh& mesh, const FileLabel& label) {
  return whole_text([&](const ByteSink& sink) { return produce_mesh_ply(mesh, sink, label); });
}

}  // namespace dubsar
