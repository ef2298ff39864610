// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace dubsar {

/// Bits of Mesh::flags. Sparse: of a sparse sample where no other scan sampled the surface well.
enum VertexFlag : std::uint8_t { kVertexSparse = 1, kVertexInterpolated = 2, kVertexBoundary = 4 };

/// A triangle mesh in the model frame, millimetres. Per-vertex arrays are either empty or as long as
/// `positions`. Faces are counter-clockwise seen from outside the clay. A value type: nothing here is
/// checked; see triangulation/mesh_check.h.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;            ///< [V], mm
  std::vector<std::array<std::uint32_t, 3>> faces;   ///< [F], indices into positions
  std::vector<Eigen::Vector3f> normals;              ///< [V] unit, or empty
  std::vector<float> reliability;                    ///< [V] in [0,1], or empty
  std::vector<float> sigma_mm;                       ///< [V] standard deviation along the normal, or empty
  std::vector<std::uint8_t> scans;                   ///< [V] how many scans support it, or empty
  std::vector<std::uint8_t> flags;                   ///< [V] VertexFlag bits, or empty
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< [V] RGB, or empty
};

/// Area-weighted vertex normals; zero where a vertex has no face with area.
[[nodiscard]] std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh);

/// Sum of the face areas, mm².
[[nodiscard]] double surface_area_mm2(const Mesh& mesh);

}  // namespace dubsar
