// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// A cut through a surface, straight down from a line over it.
struct CrossSection {
  /// One point of the cut, true to scale in its plane: `along_mm` on the straight line from the first place
  /// to the second, `height_mm` square to it, out of the surface.
  struct Point {
    double along_mm = 0;
    double height_mm = 0;
    Eigen::Vector3d place_mm{0, 0, 0};  ///< in the mesh's frame
  };
  std::vector<std::vector<Point>> lines;  ///< pieces that hang together, each and all along the cut
  double length_mm = 0;                   ///< between the two places, straight
  double lowest_mm = 0;                   ///< height of the deepest point
  double lowest_along_mm = 0;
  double highest_mm = 0;
  double first_along_mm =
      0;  ///< of all points and both places: where the cut is steeper than the line between
  double last_along_mm = 0;  ///< these, it reaches beyond them
};

/// Cuts the faces of a mesh that look towards `towards` (a unit vector, out of the surface) by the plane
/// through two places and along it, as far as they are seen from there between the two places: what looks
/// away or lies behind other faces is left out, of a tablet the far side, of a plate what stands on it hides.
/// A surface that is hidden in part ends with its last edge that is seen. Points on shared edges are computed
/// once, from the edge: the same whichever face asks. Errors: kUsage when the places lie above each other or
/// `towards` is no direction; no line where nothing is cut.
[[nodiscard]] Result<CrossSection> cross_section(const Mesh& mesh, const Eigen::Vector3d& from_mm,
                                                 const Eigen::Vector3d& to_mm,
                                                 const Eigen::Vector3d& towards);

}  // namespace dubsar
