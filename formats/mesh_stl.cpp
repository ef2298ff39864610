// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <array>

#include "formats/byte_order.h"
#include "formats/mesh_formats.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetBytes = 50;
constexpr const char* kExportAgain = "the file is cut short or no STL: copy or export it again";

/// Three appended positions become a face.
void close_facet(Mesh& mesh) {
  const auto last = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.faces.push_back({last - 3, last - 2, last - 1});
}

Result<Mesh> decode_ascii(std::string_view bytes, const std::string& where, double mm) {
  TextScanner text(bytes);
  Mesh mesh;
  for (std::size_t line_number = 1; text.remaining() > 0; ++line_number) {
    std::string_view rest = text.line();
    if (take_word(rest) != "vertex") {
      continue;
    }
    std::array<double, 3> v{};
    for (double& coordinate : v) {
      const std::string_view word = take_word(rest);
      if (!parse_number(word, coordinate)) {
        return bad_input(
            where, "line " + std::to_string(line_number) + ": " + in_quotes(word) + " is not a coordinate",
            kExportAgain);
      }
    }
    if (!append_position(mesh, mm * v[0], mm * v[1], mm * v[2])) {
      return bad_input(where, "line " + std::to_string(line_number) + ": a position is not finite",
                       kExportAgain);
    }
    if (mesh.positions.size() % 3 == 0) {
      close_facet(mesh);
    }
  }
  if (mesh.positions.size() % 3 != 0 || mesh.positions.empty()) {
    return bad_input(where, mesh.positions.empty() ? "holds no facet" : "ends within a facet", kExportAgain);
  }
  return mesh;
}

Result<Mesh> decode_binary(std::string_view bytes, const std::string& where, double mm) {
  if (bytes.size() < kHeaderBytes + 4) {
    return bad_input(where, "ends within its STL header", kExportAgain);
  }
  const auto count = load<std::uint32_t>(bytes.data() + kHeaderBytes);
  const std::size_t room = (bytes.size() - kHeaderBytes - 4) / kFacetBytes;
  if (count > room) {
    return bad_input(where, "claims " + std::to_string(count) + " facets, but holds " + std::to_string(room),
                     kExportAgain);
  }
  Mesh mesh;
  mesh.positions.reserve(std::size_t{3} * count);
  mesh.faces.reserve(count);
  for (std::uint32_t facet = 0; facet < count; ++facet) {
    const char* at = bytes.data() + kHeaderBytes + 4 + facet * kFacetBytes + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12) {
      if (!append_position(mesh, mm * static_cast<double>(load<float>(at)),
                           mm * static_cast<double>(load<float>(at + 4)),
                           mm * static_cast<double>(load<float>(at + 8)))) {
        return bad_input(where, "facet " + std::to_string(facet) + ": a position is not finite",
                         kExportAgain);
      }
    }
    close_facet(mesh);
  }
  return mesh;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes + 4) {
    return false;
  }
  const std::uint64_t count = load<std::uint32_t>(bytes.data() + kHeaderBytes);
  return bytes.size() == kHeaderBytes + 4 + count * kFacetBytes;
}

Result<Mesh> decode_mesh_stl(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  const double mm = options.mm_per_unit.value_or(1.0);
  // Binary files may begin with "solid" as well; their length tells.
  Result<Mesh> mesh = bytes.starts_with("solid") && !is_binary_stl(bytes) ? decode_ascii(bytes, where, mm)
                                                                          : decode_binary(bytes, where, mm);
  if (mesh) {
    weld_equal_positions(*mesh);
  }
  return mesh;
}

std::string encode_mesh_stl(const Mesh& mesh, const FileLabel& label) {
  // Never "solid", which would be taken for the text form.
  std::string out = label.empty() ? "Mesh of Dubsar, millimetres" : "Dubsar, mm; ";
  out += label_in_ascii(label, kHeaderBytes - out.size());
  out.resize(kHeaderBytes, ' ');
  out.reserve(kHeaderBytes + 4 + mesh.faces.size() * kFacetBytes);
  append(out, static_cast<std::uint32_t>(mesh.faces.size()));
  for (const auto& face : mesh.faces) {
    const Eigen::Vector3f& a = mesh.positions[face[0]];
    const Eigen::Vector3f& b = mesh.positions[face[1]];
    const Eigen::Vector3f& c = mesh.positions[face[2]];
    Eigen::Vector3f normal = (b - a).cross(c - a);
    normal = normal.norm() > 0 ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& three : {normal, a, b, c}) {
      append(out, three.x());
      append(out, three.y());
      append(out, three.z());
    }
    append(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace dubsar
