// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// A tablet as its planner of pins sees it: the intersection of half spaces n_k · x <= s_k whose planes touch
/// the tablet in some fifty directions. It contains the tablet, so that what it neither hides nor shows
/// shaded, the tablet does not either. Tablet frame: z out of the obverse, y to the top edge.
struct TabletHull {
  std::vector<Eigen::Vector3d> normals;  ///< [K] unit, outwards
  std::vector<double> supports_mm;       ///< [K]
  Eigen::Vector3d half_mm{0, 0, 0};      ///< half the size along x, y, z

  /// Lower bound of the distance of p from the hull; negative inside.
  [[nodiscard]] double clearance_mm(const Eigen::Vector3d& p_mm) const;
};

/// A box with edges rounded to edge_radius_mm, centred on the origin.
[[nodiscard]] TabletHull hull_of_box(const Eigen::Vector3d& size_mm, double edge_radius_mm);

/// A mesh, moved so that the middle of its bounding box in the tablet frame is the origin. No planes when the
/// mesh has no finite vertex.
[[nodiscard]] TabletHull hull_of_mesh(const Mesh& mesh, const RigidTransform& tablet_from_model);

/// The rounded box as a mesh, for pictures.
[[nodiscard]] Mesh box_mesh(const Eigen::Vector3d& size_mm, double edge_radius_mm);

}  // namespace dubsar
