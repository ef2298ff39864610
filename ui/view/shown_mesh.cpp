// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/shown_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/place_order.h"

namespace dubsar::ui {

namespace {

using Face = std::array<std::uint32_t, 3>;

constexpr std::size_t kFacesInBlock = 2048;
constexpr std::size_t kAtOnce = std::size_t{1} << 16U;

std::uint8_t byte_of(float part) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(part, 0.0F, 1.0F)));
}

std::vector<FaceBlock> blocks_of(const std::vector<Face>& faces,
                                 const std::vector<Eigen::Vector3f>& positions) {
  std::vector<FaceBlock> blocks((faces.size() + kFacesInBlock - 1) / kFacesInBlock);
  parallel_chunks(faces.size(), kFacesInBlock, [&](std::size_t begin, std::size_t end) {
    FaceBlock& block = blocks[begin / kFacesInBlock];
    block.first = static_cast<std::uint32_t>(begin);
    block.count = static_cast<std::uint32_t>(end - begin);
    for (std::size_t k = begin; k < end; ++k) {
      for (const std::uint32_t v : faces[k]) {
        block.box_mm.extend(positions[v]);
      }
    }
  });
  return blocks;
}

/// Positions that are finite, the others zero, and the box of the former.
void take_positions(const Mesh& mesh, std::vector<std::uint8_t>& finite, ShownMesh& out) {
  const std::size_t n = mesh.positions.size();
  out.positions.resize(n);
  finite.resize(n);
  out.box_mm = parallel_reduce_ordered(
      n, kAtOnce, Eigen::AlignedBox3f(),
      [&](std::size_t begin, std::size_t end) {
        Eigen::AlignedBox3f box;
        for (std::size_t v = begin; v < end; ++v) {
          finite[v] = mesh.positions[v].allFinite() ? 1 : 0;
          out.positions[v] = finite[v] != 0 ? mesh.positions[v] : Eigen::Vector3f::Zero();
          if (finite[v] != 0) {
            box.extend(out.positions[v]);
          }
        }
        return box;
      },
      [](Eigen::AlignedBox3f& into, const Eigen::AlignedBox3f& part) { into.extend(part); });
  if (out.box_mm.isEmpty()) {
    out.box_mm.extend(Eigen::Vector3f::Zero());
  }
}

/// The faces that can be drawn, and which they are; nothing in `whose` when they are all.
std::vector<Face> sound_faces(const Mesh& mesh, const std::vector<std::uint8_t>& finite,
                              std::vector<std::uint32_t>& whose) {
  const auto is_sound = [&](const Face& face) {
    return std::ranges::all_of(face, [&](std::uint32_t v) { return v < finite.size() && finite[v] != 0; });
  };
  std::vector<Face> faces;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (is_sound(mesh.faces[f])) {
      faces.push_back(mesh.faces[f]);
      whose.push_back(static_cast<std::uint32_t>(f));
    }
  }
  return faces;
}

bool all_sound(const Mesh& mesh, const std::vector<std::uint8_t>& finite) {
  std::atomic<bool> sound = true;
  parallel_chunks(mesh.faces.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      for (const std::uint32_t v : mesh.faces[f]) {
        if (v >= finite.size() || finite[v] == 0) {
          sound = false;
          return;
        }
      }
    }
  });
  return sound;
}

void take_faces(const Mesh& mesh, const std::vector<std::uint8_t>& finite, ShownMesh& out) {
  std::vector<Face> some;
  std::vector<std::uint32_t> whose;
  const bool all = all_sound(mesh, finite);
  if (!all) {
    some = sound_faces(mesh, finite, whose);
  }
  const std::vector<Face>& faces = all ? mesh.faces : some;
  out.left_out = mesh.faces.size() - faces.size();
  out.face_of = order_by_place(out.positions, faces, out.box_mm);
  out.faces.resize(faces.size());
  parallel_for_each_index(
      faces.size(),
      [&](std::size_t k) {
        out.faces[k] = faces[out.face_of[k]];
        if (!all) {
          out.face_of[k] = whose[out.face_of[k]];
        }
      },
      kAtOnce);
}

void take_normals(const Mesh& mesh, ShownMesh& out) {
  std::vector<Eigen::Vector3f> made;
  if (mesh.normals.size() != out.positions.size()) {
    Mesh sound;
    sound.positions = out.positions;
    sound.faces = out.faces;
    made = vertex_normals(sound);
  }
  const std::vector<Eigen::Vector3f>& normals = made.empty() ? mesh.normals : made;
  out.normals.resize(normals.size());
  parallel_for_each_index(
      normals.size(), [&](std::size_t v) { out.normals[v] = packed_normal(normals[v]); }, kAtOnce);
  // Those that were made are zero only where there is no face.
  out.has_normals = !made.empty() || std::ranges::find(out.normals, 0U) == out.normals.end();
}

}  // namespace

std::uint32_t packed_normal(const Eigen::Vector3f& n) {
  if (!n.allFinite()) {
    return 0;
  }
  const auto part = [](float x) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::clamp(x, -1.0F, 1.0F) * 511.0F)) & 1023U;
  };
  return part(n.x()) | (part(n.y()) << 10U) | (part(n.z()) << 20U);
}

void set_openness(ShownMesh& mesh, const std::vector<float>& openness) {
  for (std::size_t v = 0; v < mesh.traits.size(); ++v) {
    if (const std::size_t of = mesh.vertex_of.empty() ? v : mesh.vertex_of[v]; of < openness.size()) {
      mesh.traits[v][0] = byte_of(openness[of]);
    }
  }
}

std::vector<float> of_shown(const ShownMesh& mesh, const std::vector<float>& values) {
  if (mesh.vertex_of.empty()) {
    return values;
  }
  std::vector<float> out;
  out.reserve(mesh.vertex_of.size());
  for (const std::uint32_t v : mesh.vertex_of) {
    out.push_back(values[v]);
  }
  return out;
}

ShownMesh in_fewer_faces(const ShownMesh& mesh, std::size_t level) {
  ShownMesh out;
  out.box_mm = mesh.box_mm;
  out.left_out = mesh.left_out;
  out.has_normals = mesh.has_normals;
  out.has_reliability = mesh.has_reliability;
  out.has_scans = mesh.has_scans;
  out.has_flags = mesh.has_flags;
  out.instead_of_faces = mesh.instead_of_faces > 0 ? mesh.instead_of_faces : mesh.faces.size();
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  std::vector<std::uint32_t> now(mesh.positions.size(), kNone);
  const auto take = [&](std::vector<Face> faces) {
    for (Face& face : faces) {
      for (std::uint32_t& v : face) {
        if (now[v] == kNone) {
          now[v] = static_cast<std::uint32_t>(out.positions.size());
          out.positions.push_back(mesh.positions[v]);
          out.normals.push_back(mesh.normals[v]);
          out.traits.push_back(mesh.traits[v]);
          if (!mesh.colours.empty()) {
            out.colours.push_back(mesh.colours[v]);
          }
          out.vertex_of.push_back(mesh.vertex_of.empty() ? v : mesh.vertex_of[v]);
        }
        v = now[v];
      }
    }
    return faces;
  };
  const ShownLevel& finest = mesh.coarser[level];
  out.faces = take(finest.detail.faces);
  out.blocks = finest.blocks;
  for (std::size_t k = 0; k < level; ++k) {
    const ShownLevel& coarse = mesh.coarser[k];
    out.coarser.push_back({{coarse.detail.cell_mm, take(coarse.detail.faces), {}}, coarse.blocks});
  }
  return out;
}

ShownMesh fewest_faces(const ShownMesh& mesh) {
  return mesh.coarser.empty() ? mesh : in_fewer_faces(mesh, 0);
}

ShownMesh shown_mesh(const Mesh& mesh, const std::vector<float>& openness) {
  ShownMesh out;
  const std::size_t n = mesh.positions.size();
  std::vector<std::uint8_t> finite;
  take_positions(mesh, finite, out);
  take_faces(mesh, finite, out);
  take_normals(mesh, out);
  out.has_reliability = n > 0 && mesh.reliability.size() == n;
  out.has_scans = n > 0 && mesh.scans.size() == n;
  out.has_flags = n > 0 && mesh.flags.size() == n;
  out.traits.resize(n);
  parallel_for_each_index(
      n,
      [&](std::size_t v) {
        out.traits[v] = {openness.size() == n ? byte_of(openness[v]) : std::uint8_t{255},
                         out.has_reliability ? byte_of(mesh.reliability[v]) : std::uint8_t{255},
                         out.has_scans ? mesh.scans[v] : std::uint8_t{0},
                         out.has_flags ? mesh.flags[v] : std::uint8_t{0}};
      },
      kAtOnce);
  if (mesh.colours.size() == n) {
    out.colours = mesh.colours;
  }
  out.blocks = blocks_of(out.faces, out.positions);
  for (DetailLevel& level : detail_levels(out.positions, out.faces, out.box_mm, kFacesInMotion)) {
    std::vector<FaceBlock> blocks = blocks_of(level.faces, out.positions);
    out.coarser.push_back({std::move(level), std::move(blocks)});
  }
  if (!out.faces.empty()) {  // a vertex that no face has, far away, must not shrink what is looked at
    out.box_mm.setEmpty();
    for (const FaceBlock& block : out.blocks) {
      out.box_mm.extend(block.box_mm);
    }
  }
  return out;
}

}  // namespace dubsar::ui
