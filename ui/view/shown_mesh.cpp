// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/shown_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace dubsar::ui {

namespace {

constexpr std::size_t kFacesInBlock = 16384;
constexpr int kCellBits = 7;

/// Bits of a cell number spread to every third place, for Z order.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 8U)) & 0x0300F00FU;
  v = (v | (v << 4U)) & 0x030C30C3U;
  return (v | (v << 2U)) & 0x09249249U;
}

std::uint8_t byte_of(float part) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(part, 0.0F, 1.0F)));
}

void sort_into_blocks(ShownMesh& out) {
  const std::size_t n = out.faces.size();
  const Eigen::Vector3f low = out.box_mm.min();
  const float cells = static_cast<float>(1U << static_cast<unsigned>(kCellBits));
  const float longest = std::max(out.box_mm.sizes().maxCoeff(), 1e-6F);
  std::vector<std::uint32_t> key(n);
  for (std::size_t f = 0; f < n; ++f) {
    const Eigen::Vector3f at = (out.positions[out.faces[f][0]] - low) * (cells * 0.999F / longest);
    key[f] = spread(static_cast<std::uint32_t>(at.x())) | (spread(static_cast<std::uint32_t>(at.y())) << 1U) |
             (spread(static_cast<std::uint32_t>(at.z())) << 2U);
  }
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t f) { return key[f]; });
  std::vector<std::array<std::uint32_t, 3>> faces(n);
  std::vector<std::uint32_t> face_of(n);
  for (std::size_t k = 0; k < n; ++k) {
    faces[k] = out.faces[order[k]];
    face_of[k] = out.face_of[order[k]];
  }
  out.faces = std::move(faces);
  out.face_of = std::move(face_of);
  for (std::size_t first = 0; first < n; first += kFacesInBlock) {
    FaceBlock block;
    block.first = static_cast<std::uint32_t>(first);
    block.count = static_cast<std::uint32_t>(std::min(kFacesInBlock, n - first));
    for (std::size_t k = first; k < first + block.count; ++k) {
      for (const std::uint32_t v : out.faces[k]) {
        block.box_mm.extend(out.positions[v]);
      }
    }
    out.blocks.push_back(block);
  }
}

/// Vertex clustering (Rossignac and Borrel 1993), with a vertex of the mesh itself for each cluster, so that
/// the few faces need no vertices of their own.
void add_coarse(ShownMesh& out) {
  if (out.faces.size() <= kFacesInMotion * 3 / 2) {
    return;
  }
  double area = 0;
  const std::size_t stride = std::max<std::size_t>(1, out.faces.size() / 100000);
  std::size_t looked_at = 0;
  for (std::size_t f = 0; f < out.faces.size(); f += stride, ++looked_at) {
    const auto& [a, b, c] = out.faces[f];
    area +=
        0.5 * static_cast<double>(
                  (out.positions[b] - out.positions[a]).cross(out.positions[c] - out.positions[a]).norm());
  }
  area *= static_cast<double>(out.faces.size()) / static_cast<double>(std::max<std::size_t>(1, looked_at));
  // A cell that a plane crosses holds about 1.5 cell faces of it, and gives two faces.
  const float cell = static_cast<float>(std::sqrt(3.0 * area / static_cast<double>(kFacesInMotion)));
  std::unordered_map<std::uint64_t, std::uint32_t> first_in;
  std::vector<std::uint32_t> stands_for(out.positions.size());
  const Eigen::Vector3f low = out.box_mm.min();
  for (std::size_t v = 0; v < out.positions.size(); ++v) {
    const Eigen::Vector3f at = (out.positions[v] - low) / cell;
    const auto part = [](float x) { return static_cast<std::uint64_t>(std::clamp(x, 0.0F, 2000000.0F)); };
    const std::uint64_t key = part(at.x()) | (part(at.y()) << 21U) | (part(at.z()) << 42U);
    stands_for[v] = first_in.try_emplace(key, static_cast<std::uint32_t>(v)).first->second;
  }
  for (const auto& face : out.faces) {
    const std::array<std::uint32_t, 3> f{stands_for[face[0]], stands_for[face[1]], stands_for[face[2]]};
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) {
      out.coarse.push_back(f);
    }
  }
}

}  // namespace

void set_openness(ShownMesh& mesh, const std::vector<float>& openness) {
  for (std::size_t v = 0; v < mesh.traits.size() && v < openness.size(); ++v) {
    mesh.traits[v][0] = byte_of(openness[v]);
  }
}

ShownMesh shown_mesh(const Mesh& mesh, const std::vector<float>& openness) {
  ShownMesh out;
  const std::size_t n = mesh.positions.size();
  out.positions = mesh.positions;
  std::vector<std::uint8_t> finite(n);
  for (std::size_t v = 0; v < n; ++v) {
    finite[v] = out.positions[v].allFinite() ? 1 : 0;
    if (finite[v] != 0) {
      out.box_mm.extend(out.positions[v]);
    } else {
      out.positions[v].setZero();
    }
  }
  if (out.box_mm.isEmpty()) {
    out.box_mm.extend(Eigen::Vector3f::Zero());
  }
  out.faces.reserve(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (std::ranges::all_of(mesh.faces[f], [&](std::uint32_t v) { return v < n && finite[v] != 0; })) {
      out.faces.push_back(mesh.faces[f]);
      out.face_of.push_back(static_cast<std::uint32_t>(f));
    }
  }
  out.left_out = mesh.faces.size() - out.faces.size();
  if (mesh.normals.size() == n) {
    out.normals = mesh.normals;
  } else {
    Mesh sound;
    sound.positions = out.positions;
    sound.faces = out.faces;
    out.normals = vertex_normals(sound);
  }
  for (Eigen::Vector3f& normal : out.normals) {
    if (!normal.allFinite()) {
      normal.setZero();
    }
  }
  out.traits.resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    out.traits[v] = {openness.size() == n ? byte_of(openness[v]) : std::uint8_t{255},
                     mesh.reliability.size() == n ? byte_of(mesh.reliability[v]) : std::uint8_t{255},
                     mesh.scans.size() == n ? mesh.scans[v] : std::uint8_t{0},
                     mesh.flags.size() == n ? mesh.flags[v] : std::uint8_t{0}};
  }
  if (mesh.colours.size() == n) {
    out.colours = mesh.colours;
  }
  sort_into_blocks(out);
  add_coarse(out);
  return out;
}

}  // namespace dubsar::ui
