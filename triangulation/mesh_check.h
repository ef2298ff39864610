// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>

#include "core/job.h"
#include "core/mesh.h"
#include "triangulation/count_work.h"

namespace dubsar {

/// What is to be known about a mesh's topology and shape. A mesh is an oriented 2-manifold with boundary when
/// is_manifold() holds.
struct MeshReport {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t components = 0;         ///< of faces joined across edges, whichever way they run
  std::size_t largest_component = 0;  ///< its faces
  std::size_t boundary_edges = 0;     ///< with a single face
  /// Walks that each of them is in once; one begins and ends where more than two faces meet, or is closed.
  std::size_t boundary_loops = 0;
  double boundary_length_mm = 0;
  double longest_boundary_loop_mm = 0;
  std::size_t non_manifold_edges = 0;     ///< with more than two faces
  std::size_t non_manifold_vertices = 0;  ///< whose faces do not all hang together across edges there
  std::size_t inconsistent_edges = 0;     ///< whose two faces run along it in the same direction
  std::size_t inconsistent_faces = 0;     ///< faces at such an edge
  std::size_t degenerate_faces = 0;       ///< a vertex twice, an index out of range, not finite, or no area
  std::size_t duplicate_faces = 0;        ///< the same three vertices as an earlier face
  std::size_t repeated_faces = 0;  ///< other vertices in the same three places as those of an earlier face
  std::size_t self_intersections = 0;  ///< pairs that cut through each other, not of one plane; no duplicates
  std::size_t unreferenced_vertices = 0;
  double thin_share = 0;  ///< faces with an angle below 10°, of all, in [0,1]
  double min_angle_rad = 0;
  double area_mm2 = 0;
  Eigen::AlignedBox3f box;  ///< of the referenced vertices; empty without any

  [[nodiscard]] bool is_manifold() const {
    return non_manifold_edges == 0 && non_manifold_vertices == 0 && inconsistent_edges == 0 &&
           degenerate_faces == 0 && duplicate_faces == 0 && repeated_faces == 0;
  }
  [[nodiscard]] bool is_closed() const { return is_manifold() && faces > 0 && boundary_edges == 0; }
};

/// Checks any mesh, broken indices included; faces with an index out of range count as degenerate and take no
/// further part. Of a job that is cancelled the report holds what is known by then, and is none of the mesh.
/// `counted`: of the search for self-intersections.
[[nodiscard]] MeshReport check_mesh(const Mesh& mesh, const JobContext& job = {},
                                    const CountWork& counted = {});
/// What is_manifold() goes by, but for repeated faces, in a third of the time: these, components, loops and
/// self-intersections stay 0.
[[nodiscard]] MeshReport check_manifold(const Mesh& mesh);

}  // namespace dubsar
