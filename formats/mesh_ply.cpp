// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/log.h"
#include "core/number_text.h"
#include "core/parallel.h"
#include "formats/byte_order.h"
#include "formats/bytes_left_over.h"
#include "formats/colour_values.h"
#include "formats/filed_mesh.h"
#include "formats/mesh_formats.h"
#include "formats/ply_body.h"
#include "formats/ply_passed_over.h"
#include "formats/ply_scan.h"
#include "formats/scan_samples.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export the mesh again";
constexpr std::size_t kRowsAtOnce = std::size_t{1} << 16U;

/// Where the vertex properties stand; -1 for those that are absent.
struct Columns {
  std::array<int, 3> position, normal;
  int reliability, sigma, scans, flags;

  explicit Columns(const PlyElement& vertex)
      : position{vertex.scalar("x"), vertex.scalar("y"), vertex.scalar("z")},
        normal{vertex.scalar("nx"), vertex.scalar("ny"), vertex.scalar("nz")},
        reliability(vertex.scalar("reliability")),
        sigma(vertex.scalar("sigma")),
        scans(vertex.scalar("scans")),
        flags(marks_property(vertex)) {}
  [[nodiscard]] static bool has(const std::array<int, 3>& three) {
    return std::all_of(three.begin(), three.end(), [](int p) { return p >= 0; });
  }
};

/// NaN and what lies outside become the nearest byte.
std::uint8_t byte_of(double value) {
  return value > 0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : std::uint8_t{0};
}

/// As long as the element claims, which check_claim() has compared with the bytes that are there.
void resize_vertices(const Columns& columns, std::size_t count, Mesh& mesh) {
  mesh.positions.resize(count);
  mesh.normals.resize(Columns::has(columns.normal) ? count : 0);
  mesh.reliability.resize(columns.reliability >= 0 ? count : 0);
  mesh.sigma_mm.resize(columns.sigma >= 0 ? count : 0);
  mesh.scans.resize(columns.scans >= 0 ? count : 0);
  mesh.flags.resize(columns.flags >= 0 ? count : 0);
}

/// value(property) -> double. False where the position is not finite.
template <class Value>
bool put_vertex(const Columns& columns, double mm, const Value& value, std::size_t v, Mesh& mesh,
                PlyColours& colours) {
  const auto three = [&](const std::array<int, 3>& of, double scale) {
    return Eigen::Vector3f(static_cast<float>(scale * value(of[0])), static_cast<float>(scale * value(of[1])),
                           static_cast<float>(scale * value(of[2])));
  };
  mesh.positions[v] = three(columns.position, mm);
  if (!mesh.positions[v].allFinite()) {
    return false;
  }
  if (Columns::has(columns.normal)) {
    const Eigen::Vector3f n = three(columns.normal, 1);
    // One that is unit but for rounding stays, to the bit.
    constexpr float kRounding = 1e-6F;
    mesh.normals[v] = std::abs(n.squaredNorm() - 1) <= kRounding ? n : unit_or_zero(n);
  }
  if (columns.reliability >= 0) {
    const double reliability = value(columns.reliability);
    mesh.reliability[v] = reliability > 0 ? static_cast<float>(std::min(reliability, 1.0)) : 0.0F;
  }
  if (columns.sigma >= 0) {
    const double sigma = mm * value(columns.sigma);
    mesh.sigma_mm[v] = sigma > 0 && std::isfinite(sigma) ? static_cast<float>(sigma) : 0.0F;
  }
  if (columns.scans >= 0) {
    mesh.scans[v] = byte_of(value(columns.scans));
  }
  if (columns.flags >= 0) {
    mesh.flags[v] = byte_of(value(columns.flags));
  }
  colours.put(v, value);
  return true;
}

/// Vertices of one size each in a binary file, many at a time. False, and nothing is passed over, where they
/// are not so, or one is not sound: then they are to be read one by one, for the error's sake.
bool read_vertices_at_once(PlyBody& body, const PlyElement& vertex, const Columns& columns, double mm,
                           Mesh& mesh, PlyColours& colours) {
  std::vector<std::size_t> offsets;
  std::size_t stride = 0;
  for (const PlyProperty& property : vertex.properties) {
    if (property.count_type) {
      return false;
    }
    offsets.push_back(stride);
    stride += size_of(property.type);
  }
  const std::string_view rows = body.ahead(vertex.count * stride);
  if (rows.empty()) {
    return false;
  }
  std::atomic<bool> sound = true;
  parallel_chunks(static_cast<std::size_t>(vertex.count), kRowsAtOnce,
                  [&](std::size_t begin, std::size_t end) {
                    for (std::size_t v = begin; v < end; ++v) {
                      const char* row = rows.data() + v * stride;
                      const auto value = [&](int property) {
                        const auto p = static_cast<std::size_t>(property);
                        return load_as_double(row + offsets[p], vertex.properties[p].type, body.byte_order());
                      };
                      if (!put_vertex(columns, mm, value, v, mesh, colours)) {
                        sound = false;
                        return;
                      }
                    }
                  });
  if (sound) {
    body.pass(rows);
  }
  return sound;
}

/// Faces that are all triangles and nothing else, as scanners and Dubsar write them. False like above.
bool read_triangles_at_once(PlyBody& body, const PlyElement& face, std::uint64_t vertices, Mesh& mesh) {
  const PlyProperty& list = face.properties.front();
  if (face.properties.size() != 1 || !list.count_type || size_of(*list.count_type) != 1 ||
      (list.type != PlyType::kInt32 && list.type != PlyType::kUint32)) {
    return false;
  }
  constexpr std::size_t kStride = 1 + 3 * sizeof(std::uint32_t);
  if (!body.check_claim(face)) {  // the product may be beyond 64 bits, and few again
    return false;
  }
  const std::string_view rows = body.ahead(face.count * kStride);
  if (rows.empty()) {
    return false;
  }
  mesh.faces.resize(static_cast<std::size_t>(face.count));
  std::atomic<bool> sound = true;
  parallel_chunks(mesh.faces.size(), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const char* row = rows.data() + f * kStride;
      bool good = *row == 3;
      for (std::size_t k = 0; k < 3; ++k) {
        // An index below 0 is far above all others here.
        mesh.faces[f][k] = load<std::uint32_t>(row + 1 + 4 * k, body.byte_order());
        good = good && mesh.faces[f][k] < vertices;
      }
      if (!good) {
        sound = false;
        return;
      }
    }
  });
  if (sound) {
    body.pass(rows);
  } else {
    mesh.faces.clear();
  }
  return sound;
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
  const auto count = static_cast<std::size_t>(vertex.count);
  resize_vertices(columns, count, mesh);
  PlyColours colours(vertex);
  if (read_vertices_at_once(body, vertex, columns, mm, mesh, colours)) {
    mesh.colours = colours.take();
    return {};
  }
  const Status read = body.read(vertex, [&](std::uint64_t index, const PlyRow& row) -> Status {
    const auto value = [&](int property) { return row.value(property); };
    if (!put_vertex(columns, mm, value, static_cast<std::size_t>(index), mesh, colours)) {
      return body.error_at(vertex, index, "its position is not finite", kExportAgain);
    }
    return {};
  });
  mesh.colours = colours.take();
  return read;
}

/// The property that lists vertices, or -1.
int vertex_list(const PlyElement& face) {
  int list = -1;
  for (std::size_t p = 0; p < face.properties.size(); ++p) {
    const std::string& name = face.properties[p].name;
    if (face.properties[p].count_type && (name == "vertex_indices" || name == "vertex_index")) {
      list = static_cast<int>(p);
    }
  }
  return list;
}

std::unexpected<Error> no_such_vertex(const PlyBody& body, const PlyElement& element, std::uint64_t index,
                                      double corner, std::uint64_t vertices) {
  return body.error_at(
      element, index,
      "vertex index " + number_text(corner) + " is not one of the " + std::to_string(vertices) + " vertices",
      kExportAgain);
}

bool is_index(double corner, std::uint64_t vertices) {
  return corner >= 0 && corner < static_cast<double>(vertices) && corner == std::floor(corner);
}

/// Triangle strips, as trimesh2 and some of Stanford's files have them: each vertex makes a triangle with the
/// two before it, every other one turned over; -1 begins anew.
Status read_strips(PlyBody& body, const PlyElement& strips, std::uint64_t vertices, const std::string& where,
                   Mesh& mesh) {
  const int list = vertex_list(strips);
  if (list < 0) {
    return bad_input(where, "its tristrips have no list vertex_indices", kExportAgain);
  }
  return body.read(strips, [&](std::uint64_t index, const PlyRow& row) -> Status {
    std::array<std::uint32_t, 2> last{};
    std::size_t length = 0;
    for (const double corner : row.lists[static_cast<std::size_t>(list)]) {
      if (corner == -1) {
        length = 0;
        continue;
      }
      if (!is_index(corner, vertices)) {
        return no_such_vertex(body, strips, index, corner, vertices);
      }
      const auto v = static_cast<std::uint32_t>(corner);
      const std::size_t turned = length % 2;
      // One without area only leads on to the next.
      if (length >= 2 && v != last[0] && v != last[1] && last[0] != last[1]) {
        mesh.faces.push_back({last[turned], last[1 - turned], v});
      }
      last = {last[1], v};
      ++length;
    }
    return {};
  });
}

/// One of one or two corners stays as a degenerate face, which the mesh check counts.
void append_polygon_or_fault(Mesh& mesh, const std::vector<std::uint32_t>& corners) {
  if (corners.size() == 1 || corners.size() == 2) {
    mesh.faces.push_back({corners.front(), corners.back(), corners.back()});
  } else {
    append_polygon(mesh, corners);
  }
}

Status read_faces(PlyBody& body, const PlyElement& face, std::uint64_t vertices, const std::string& where,
                  Mesh& mesh) {
  const int list = vertex_list(face);
  if (list < 0 && face.count > 0) {
    return bad_input(where, "its faces have no list vertex_indices", kExportAgain);
  }
  if (mesh.faces.empty() && face.count > 0 && read_triangles_at_once(body, face, vertices, mesh)) {
    return {};
  }
  std::vector<std::uint32_t> corners;
  return body.read(face, [&](std::uint64_t index, const PlyRow& row) -> Status {
    corners.clear();
    for (const double corner : row.lists[static_cast<std::size_t>(list)]) {
      if (!is_index(corner, vertices)) {
        return no_such_vertex(body, face, index, corner, vertices);
      }
      corners.push_back(static_cast<std::uint32_t>(corner));
    }
    append_polygon_or_fault(mesh, corners);
    return {};
  });
}

}  // namespace

Result<Mesh> decode_mesh_ply(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  return mesh_of(decode_filed_ply(bytes, where, options));
}

Result<FiledMesh> decode_filed_ply(std::string_view bytes, const std::string& where,
                                   const MeshReadOptions& options) {
  const Result<PlyHeader> header = parse_ply_header(bytes, where);
  if (!header) {
    return std::unexpected(header.error());
  }
  const PlyElement* vertex = header->element("vertex");
  const auto refused = [&](const char* why) {
    return bad_input(where, why, "give a mesh; scans become one with dubsar stitch");
  };
  constexpr const char* kNoFaces = "a PLY file without faces";
  const bool claims_faces = std::ranges::any_of(header->elements, [](const PlyElement& element) {
    return (element.name == "face" || element.name == "tristrips") && element.count > 0;
  });
  if (vertex == nullptr || (!claims_faces && !options.may_be_points)) {
    return refused(vertex == nullptr ? "a PLY file without vertices" : kNoFaces);
  }
  const Result<double> said = mm_per_unit_of(*header, where);
  if (!said && !options.mm_per_unit) {
    return std::unexpected(said.error());
  }
  const double mm = options.mm_per_unit ? *options.mm_per_unit : *said;
  PlyBody body(*header, bytes, where, options.job);
  Mesh mesh;
  const std::uint64_t vertices = std::min<std::uint64_t>(vertex->count, 0xffffffffU);
  for (const PlyElement& element : header->elements) {
    if (is_stopped(options.job)) {
      return reading_stopped(where);
    }
    Status status;
    if (element.name == "vertex") {
      status = read_vertices(body, element, mm, where, mesh);
    } else if (element.name == "face") {
      status = read_faces(body, element, vertices, where, mesh);
    } else if (element.name == "tristrips") {
      status = read_strips(body, element, vertices, where, mesh);
    } else {
      status = body.skip(element);
    }
    if (!status) {
      return std::unexpected(status.error());
    }
  }
  const auto is_line = [](const auto& face) { return face[1] == face[2]; };
  if (std::ranges::all_of(mesh.faces, is_line) && !options.may_be_points) {
    return refused(kNoFaces);
  }
  if (options.passed_over != nullptr) {
    *options.passed_over = passed_over_of_mesh(*header);
  }
  if (const std::string left_over = bytes_left_over(body.rest()); !left_over.empty()) {
    log_warning(Error{ErrorKind::kBadInput, left_over, where, {}}.line());
  }
  if (has_texture_places(*vertex) && !mesh.faces.empty()) {
    return welded(std::move(mesh));
  }
  const std::size_t count = mesh.positions.size();
  return FiledMesh{std::move(mesh), count};
}

}  // namespace dubsar
