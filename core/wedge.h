// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/red_map.h"

namespace dubsar {

/// The two definitions of where an inner edge ends (seed 000, 3.4).
enum class ExitDefinition {
  kSurface,  ///< where it meets the reconstructed free surface
  kExtent,   ///< the farthest contact point of its faces, projected on it
};

/// What decided on the directional edge.
enum class DirectionalBy {
  kBoth,      ///< the longest inner edge is also the flattest
  kLongest,   ///< they differ; the longest one leads by more
  kFlattest,  ///< they differ; the flattest one leads by more
};
inline constexpr std::array<std::string_view, 3> kDirectionalByNames = {"longest and flattest", "longest",
                                                                        "flattest"};

/// Standard deviations of what was measured, from reliability, the scatter of the vertices and how well the
/// free surface is known. No number where nobody knows: of lengths and volume with ExitDefinition::kExtent,
/// and of what a file does not say.
struct WedgeSigma {
  double depth_point_mm = 0;  ///< of the point, all three axes together
  double depth_mm = 0;
  std::array<double, 3> edge_rad{};        ///< of each inner edge's direction
  std::array<double, 3> edge_slope_rad{};  ///< which way the free surface looks included
  std::array<double, 3> opening_rad{};
  std::array<double, 3> face_angle_rad{};
  std::array<double, 3> face_slope_rad{};
  std::array<double, 3> length_mm{};
  double volume_mm3 = 0;

  /// Of edges that end where they were seen last: how far that is from where they ended once nobody knows.
  void forget_lengths() {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    length_mm.fill(kUnknown);
    volume_mm3 = kUnknown;
  }
};

/// Where a wedge stands in the text.
struct WedgePlace {
  std::optional<Face> side;
  int line = 0;         ///< from 1, down the side; 0 when not known
  int order = 0;        ///< from 1, along the line; 0 when not known
  double turn_rad = 0;  ///< of the directional edge away from the depth point: 0 right, pi/2 up the side
  int body = 0;         ///< of the mesh, from 1 by falling area; 0 where it holds one only
};

/// Whether a person had a say in where the wedge is: its measures are made by the same code all the same.
enum class ByHand { kNo, kMerged, kSplit, kAdded };
inline constexpr std::array<std::string_view, 4> kByHandNames = {"no", "merged", "split", "added"};

/// Eigen leaves unset what {} makes.
[[nodiscard]] inline std::array<Eigen::Vector3d, 3> three_zeros() {
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
}

/// One wedge as an idealised tetrahedron (seed 000, 3.4; contract "Wedges" in design.md). Millimetres,
/// radians. Inner edges and faces counter-clockwise seen from outside the clay, of a measured wedge from the
/// directional edge on; of one made up, or read from a file, from any. Face k lies between inner edges k and
/// k+1; face_angles_rad[k] is the angle between these two edges at the depth point; opening_angles_rad[k] the
/// dihedral angle between the two faces that meet in inner edge k.
struct Wedge {
  int id = 0;
  Eigen::Vector3d depth_point_mm{0, 0, 0};
  std::array<Eigen::Vector3d, 3> exit_points_mm = three_zeros();  ///< by inner edge, by the chosen definition
  std::array<Eigen::Vector3d, 3> exit_points_surface_mm = three_zeros();  ///< ExitDefinition::kSurface
  std::array<Eigen::Vector3d, 3> exit_points_extent_mm = three_zeros();   ///< ExitDefinition::kExtent
  int directional_edge = 0;
  DirectionalBy directional_by = DirectionalBy::kBoth;
  double directional_margin = 0;  ///< by how much it leads the next, as a share: of length or of slope
  std::array<Eigen::Vector3d, 3> outer_vertices_mm = three_zeros();
  std::array<Eigen::Vector3d, 3> face_normals = three_zeros();  ///< out of the clay
  Eigen::Vector3d surface_normal{0, 0, 0};  ///< mean of the free surface over the hollow, by area
  double depth_mm = 0;                      ///< of the depth point below the free surface
  std::array<double, 3> face_angles_rad{};
  std::array<double, 3> opening_angles_rad{};
  std::array<double, 3> edge_lengths_mm{};  ///< depth point to exit point
  std::array<double, 3> edge_slopes_rad{};  ///< of the inner edges against the free surface
  std::array<double, 3> face_slopes_rad{};
  std::array<double, 3> edge_bows_mm{};  ///< of an inner edge that is a curve: its middle off the chord
  double volume_mm3 = 0;                 ///< of the tetrahedron
  WedgeSigma sigma;
  WedgePlace place;
  double reliability = 0;
  double confidence = 0;
  int vertex_count = 0;
  double intact = 1.0;                                   ///< share of the three faces that is there
  std::array<double, 3> faces_intact = {1.0, 1.0, 1.0};  ///< of each of them; NaN where nothing says it
  std::array<bool, 3> beyond_mesh{};  ///< of each inner edge: the mesh ends before it, its exit is in the air
  /// How far its faces are from planes: 0 for planes, 0.6 to 0.85 for cones and bowls, more the more its
  /// edges are worn (analysis/roundness.h); NaN where nothing says it.
  double roundness = 0;
  ByHand by_hand = ByHand::kNo;
};

/// A hollow that was taken for a wedge at first, and what spoke against it.
struct RejectedWedge {
  std::string reason;
  Eigen::Vector3d depth_point_mm{0, 0, 0};
};

}  // namespace dubsar
