// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "core/detail_levels.h"
#include "core/mesh.h"

namespace dubsar::ui {

/// Neighbouring faces that are drawn, or left out, together.
struct FaceBlock {
  std::uint32_t first = 0;  ///< in the faces of its level
  std::uint32_t count = 0;
  Eigen::AlignedBox3f box_mm;
};

/// The surface in fewer faces.
struct ShownLevel {
  DetailLevel detail;  ///< its faces are made of those of ShownMesh::faces
  std::vector<FaceBlock> blocks;
};

/// A mesh made ready for drawing; can be made on any thread. Vertices are those of the mesh, once each; faces
/// that cannot be drawn (an index out of range, a coordinate that is not a number) are left out, and the
/// others are put in order of place. Without faces it is drawn as points.
struct ShownMesh {
  std::vector<Eigen::Vector3f> positions;            ///< [V] mm
  std::vector<std::uint32_t> normals;                ///< [V] packed_normal(); zero where there is none
  std::vector<std::array<std::uint8_t, 4>> traits;   ///< [V] openness, reliability (255: 1), scans, flags
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< [V] or empty
  std::vector<std::array<std::uint32_t, 3>> faces;   ///< by block
  std::vector<std::uint32_t> face_of;                ///< [faces] which face of the mesh it is
  std::vector<FaceBlock> blocks;
  std::vector<ShownLevel> coarser;  ///< the same surface in fewer faces, fewest first
  Eigen::AlignedBox3f box_mm;       ///< of the faces; without any, of the vertices
  std::size_t left_out = 0;         ///< faces of the mesh that cannot be drawn
  // What the mesh says of its vertices; `traits` hold nothing that counts where it does not.
  bool has_normals = false;  ///< for every vertex of a face
  bool has_reliability = false;
  bool has_scans = false;
  bool has_flags = false;
  // Of one in fewer faces, which has no face_of and whose levels have no `from`:
  std::vector<std::uint32_t> vertex_of;  ///< [V] which vertex of the mesh each is; empty: the same
  std::size_t instead_of_faces = 0;      ///< so many faces of the mesh could be drawn; 0: they are
};

/// A unit vector in 4 bytes, signed, 10 bits a coordinate, as the graphics card takes it.
[[nodiscard]] std::uint32_t packed_normal(const Eigen::Vector3f& n);

/// Faces that even a processor draws fast enough to be turned by hand (bench: 34 thousand in about 25 ms).
inline constexpr std::size_t kFacesInMotion = 40000;

/// Puts ambient occlusion, in [0, 1] for each vertex of the mesh, into the traits.
void set_openness(ShownMesh& mesh, const std::vector<float>& openness);

/// A coarser level of it as a mesh of its own, with the vertices that this has and the levels that are
/// coarser still.
[[nodiscard]] ShownMesh in_fewer_faces(const ShownMesh& mesh, std::size_t level);
/// The coarsest level; itself where there is none.
[[nodiscard]] ShownMesh fewest_faces(const ShownMesh& mesh);
/// Of numbers per vertex of the mesh those of the vertices that are shown.
[[nodiscard]] std::vector<float> of_shown(const ShownMesh& mesh, const std::vector<float>& values);

/// `openness` is ambient occlusion, [V] in [0, 1], or empty.
[[nodiscard]] ShownMesh shown_mesh(const Mesh& mesh, const std::vector<float>& openness = {});

}  // namespace dubsar::ui
