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
  /// One point of the cut: `along_mm` from the first place towards the second, `height_mm` above the straight
  /// line between the two places, against the direction of the cut.
  struct Point {
    double along_mm = 0;
    double height_mm = 0;
    Eigen::Vector3d place_mm{0, 0, 0};  ///< in the mesh's frame
  };
  std::vector<std::vector<Point>> lines;  ///< pieces that hang together, each and all along the cut
  double length_mm = 0;                   ///< between the two places, across the direction of the cut
  double lowest_mm = 0;                   ///< height of the deepest point
  double lowest_along_mm = 0;
  double highest_mm = 0;
};

/// Cuts the faces of a mesh that look towards `towards` (a unit vector, out of the surface) by the plane
/// through two places and along it. Faces that look away are not cut: of a tablet it is the near side that
/// shows. Points on shared edges are computed once, from the edge: the same whichever face asks. Errors:
/// kUsage when the places lie above each other or `towards` is no direction; no line where nothing is cut.
[[nodiscard]] Result<CrossSection> cross_section(const Mesh& mesh, const Eigen::Vector3d& from_mm,
                                                 const Eigen::Vector3d& to_mm,
                                                 const Eigen::Vector3d& towards);

}  // namespace dubsar
