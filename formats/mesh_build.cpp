// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "formats/filed_mesh.h"
#include "formats/mesh_formats.h"

namespace dubsar {

namespace {

using Key = std::array<std::uint32_t, 3>;

/// -0 and 0 are one place.
Key key_of(const Eigen::Vector3f& p) {
  return {std::bit_cast<std::uint32_t>(p.x() + 0.0F), std::bit_cast<std::uint32_t>(p.y() + 0.0F),
          std::bit_cast<std::uint32_t>(p.z() + 0.0F)};
}

std::size_t hash_of(const Key& key) {
  std::uint64_t h = key[0] * 0x9e3779b97f4a7c15ULL;
  h = (h ^ (h >> 32U) ^ key[1]) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 29U) ^ key[2]) * 0x94d049bb133111ebULL;
  return static_cast<std::size_t>(h ^ (h >> 31U));
}

constexpr std::uint32_t kEmpty = 0xffffffffU;

using Eigen::Vector3d;

Vector3d cross_at(const Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vector3d p = mesh.positions[a].cast<double>();
  return (mesh.positions[b].cast<double>() - p).cross(mesh.positions[c].cast<double>() - p);
}

/// Twice the polygon's area, along its normal.
Vector3d area_of(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  Vector3d area = Vector3d::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k) {
    area += cross_at(mesh, corners[0], corners[k - 1], corners[k]);
  }
  return area;
}

/// Whether no triangle of the fan from its first corner is turned over.
bool fans_out(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  const Vector3d normal = area_of(mesh, corners);
  for (std::size_t k = 2; k < corners.size(); ++k) {
    if (cross_at(mesh, corners[0], corners[k - 1], corners[k]).dot(normal) < 0) {
      return false;
    }
  }
  return true;
}

/// The triangles of a polygon that need not be convex, ear by ear; where there is none (it crosses itself)
/// the rest is a fan.
void clip_ears(Mesh& mesh, std::vector<std::uint32_t> corners) {
  const Vector3d normal = area_of(mesh, corners);
  const auto is_left = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return cross_at(mesh, a, b, c).dot(normal) > 0;
  };
  while (corners.size() > 3) {
    const std::size_t n = corners.size();
    std::size_t ear = 0;
    for (; ear < n; ++ear) {
      const std::uint32_t a = corners[(ear + n - 1) % n], b = corners[ear], c = corners[(ear + 1) % n];
      if (is_left(a, b, c) && std::ranges::none_of(corners, [&](std::uint32_t v) {
            return v != a && v != b && v != c && is_left(a, b, v) && is_left(b, c, v) && is_left(c, a, v);
          })) {
        mesh.faces.push_back({a, b, c});
        break;
      }
    }
    if (ear == n) {
      break;
    }
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

}  // namespace

bool append_position(Mesh& mesh, double x_mm, double y_mm, double z_mm) {
  const Eigen::Vector3f p(static_cast<float>(x_mm), static_cast<float>(y_mm), static_cast<float>(z_mm));
  if (!p.allFinite()) {
    return false;
  }
  mesh.positions.push_back(p);
  return true;
}

std::string whole_text(const ByteProducer& produce) {
  std::string out;
  (void)produce([&](std::span<const std::byte> bytes) -> Status {
    out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  });
  return out;
}

std::unexpected<Error> reading_stopped(const std::string& where) {
  return fail(ErrorKind::kCancelled, "reading was stopped", where);
}

void append_polygon(Mesh& mesh, std::span<const std::uint32_t> corners) {
  // Without its places, or so long that it would take too much time, a polygon is taken for a convex one.
  constexpr std::size_t kMostClipped = 64;
  const bool placed =
      std::ranges::all_of(corners, [&](std::uint32_t v) { return v < mesh.positions.size(); });
  if (corners.size() > 3 && corners.size() <= kMostClipped && placed && !fans_out(mesh, corners)) {
    clip_ears(mesh, {corners.begin(), corners.end()});
    return;
  }
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.faces.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

namespace {

/// [V] the vertex that each becomes.
std::vector<std::uint32_t> weld(Mesh& mesh) {
  // Open addressing at no more than half load; looked up only, so the order of the table never shows.
  std::vector<std::uint32_t> table(std::bit_ceil(2 * mesh.positions.size() + 2), kEmpty);
  std::vector<std::uint32_t> new_index(mesh.positions.size());
  std::uint32_t kept = 0;
  mesh.normals.clear();
  const auto move_to = [&](std::size_t target, std::size_t v) {
    const auto move = [&](auto& values) {
      if (!values.empty()) {
        values[target] = values[v];
      }
    };
    move(mesh.positions);
    move(mesh.reliability);
    move(mesh.sigma_mm);
    move(mesh.scans);
    move(mesh.flags);
    move(mesh.colours);
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Key key = key_of(mesh.positions[v]);
    std::size_t slot = hash_of(key) & (table.size() - 1);
    while (table[slot] != kEmpty && key_of(mesh.positions[table[slot]]) != key) {
      slot = (slot + 1) & (table.size() - 1);
    }
    if (table[slot] == kEmpty) {
      move_to(kept, v);
      table[slot] = kept++;
    }
    new_index[v] = table[slot];
  }
  const auto cut = [&](auto& values) { values.resize(values.empty() ? 0 : kept); };
  cut(mesh.positions);
  cut(mesh.reliability);
  cut(mesh.sigma_mm);
  cut(mesh.scans);
  cut(mesh.flags);
  cut(mesh.colours);
  for (auto& face : mesh.faces) {
    for (std::uint32_t& corner : face) {
      corner = new_index[corner];
    }
  }
  return new_index;
}

}  // namespace

void weld_equal_positions(Mesh& mesh) {
  (void)weld(mesh);
}

FiledMesh welded(Mesh mesh) {
  FiledMesh out{std::move(mesh)};
  std::vector<std::uint32_t> vertex_of = weld(out.mesh);
  out.file_vertices = vertex_of.size();
  if (vertex_of.size() != out.mesh.positions.size()) {
    out.vertex_of = std::move(vertex_of);
  }
  return out;
}

Result<Mesh> mesh_of(Result<FiledMesh> filed) {
  return filed ? Result<Mesh>(std::move(filed->mesh)) : std::unexpected(filed.error());
}

}  // namespace dubsar
