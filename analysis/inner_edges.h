// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "analysis/wedge_faces.h"
#include "analysis/wedge_patch.h"

namespace dubsar {

/// An inner edge from its contact points, in the patch's frame.
struct InnerEdge {
  Eigen::Vector3d direction{0, 0, 1};  ///< unit, out of the depth point
  double sigma_rad = 0;                ///< of the direction
  double rms_mm = 0;                   ///< their distance
  double extent_mm = 0;                ///< farthest contact point along it
  /// Between the line of its contact points and the one that its faces' planes meet in; no number where too
  /// few contact points lie in a line.
  double off_planes_rad = std::numeric_limits<double>::quiet_NaN();
  double bow_mm = 0;  ///< middle of the curve off its chord; 0 where a line is as good
};

struct InnerEdges {
  Eigen::Vector3d depth_point{0, 0, 0};
  double depth_point_sigma_mm = 0;
  std::array<InnerEdge, 3> edge{};
};

/// Inner edges and depth point of three faces (seed 000, 3.4). The contact points of two faces, weighted by
/// reliability and less near the dirt-prone centre, give a line by RANSAC (draws follow from the lowest
/// vertex); then the shared point is found that the three lines and the three planes agree on, and each edge
/// is fitted again through it, as a line or, where that is clearly better, a curve. Where contact points are
/// few or far off, the planes' intersection stands in for them, by the uncertainty of either.
[[nodiscard]] InnerEdges find_inner_edges(const WedgePatch& patch, const WedgeFaces& faces);

}  // namespace dubsar
