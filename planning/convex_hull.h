// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace dubsar {

/// The points that lie farthest along each of the directions, each once, in the order of the points: a small
/// set whose hull is close to the hull of all.
[[nodiscard]] std::vector<Eigen::Vector3d> extreme_points(std::span<const Eigen::Vector3f> points,
                                                          std::span<const Eigen::Vector3d> directions);

/// Extreme points over the sphere, then along the normals of their hull's faces, where flat sides of the
/// model would be cut short.
[[nodiscard]] std::vector<Eigen::Vector3d> hull_points(std::span<const Eigen::Vector3f> points);

/// Every so many-th point: of millions, some ten thousand show the hull.
[[nodiscard]] std::vector<Eigen::Vector3f> thinned_for_hull(std::span<const Eigen::Vector3f> points);

/// Convex hull of some hundred points, faces counter-clockwise from outside; only its corners are used by the
/// faces: a closed surface, whatever lies in one plane or on one line. No faces when all points lie in a
/// plane, or when one is not finite. Incremental (de Berg et al., Computational Geometry, ch. 11), decided
/// exactly, time O(n²): thin the points with extreme_points() first.
[[nodiscard]] Mesh convex_hull(std::span<const Eigen::Vector3d> points);

}  // namespace dubsar
