// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace dubsar {

/// One wedge as an idealised tetrahedron (seed 000, 3.4; contract "Wedges" in design.md). Millimetres,
/// radians. Face k lies between inner edges k and k+1; face_angles_rad[k] is the angle between these two
/// edges at the depth point; opening_angles_rad[k] the dihedral angle between the two faces that meet in
/// inner edge k.
struct Wedge {
  int id = 0;
  Eigen::Vector3d depth_point_mm{0, 0, 0};
  std::array<Eigen::Vector3d, 3> exit_points_mm{};  ///< by inner edge
  int directional_edge = 0;
  std::array<Eigen::Vector3d, 3> outer_vertices_mm{};
  std::array<Eigen::Vector3d, 3> face_normals{};  ///< out of the clay
  double depth_mm = 0;                            ///< of the depth point below the free surface
  std::array<double, 3> face_angles_rad{};
  std::array<double, 3> opening_angles_rad{};
  double reliability = 0;
  double confidence = 0;
  int vertex_count = 0;
  double intact = 1.0;  ///< share of the impression that later wedges and damage left, truth only
};

}  // namespace dubsar
