// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/mesh.h"
#include "core/placed_scan.h"
#include "core/red_map.h"

namespace dubsar {

/// How the six faces lie in the model frame: columns are the directions of the right edge (x), the top edge
/// (y) and the obverse (z).
///
/// Where a scan came with a nominal pose, its tablet frame says so: the frame of the registered scan of the
/// lowest id. Otherwise the faces follow from the shape: the thickness is the smallest extent, the obverse
/// the side that the first scan looked at, and up, of the four directions along the edges, the one nearest to
/// the first scan's y axis (x where y runs across the faces), as tablet_frame() has it: a tablet may be wider
/// than high. Of what is about as wide as high (5 %) that axis itself is up.
struct ModelFaces {
  Eigen::Matrix3d model_from_faces = Eigen::Matrix3d::Identity();

  [[nodiscard]] Eigen::Vector3d normal(Face face) const;
  /// The face that a surface with this outward normal belongs to.
  [[nodiscard]] Face of(const Eigen::Vector3d& normal) const;
};

/// hull: the model's convex hull; without faces, all stands as the model does.
[[nodiscard]] ModelFaces model_faces(std::span<const PlacedScan> scans, const Mesh& hull);

/// The same from a surface's vertices, by their convex hull: all who name faces of one model agree, and where
/// the vertices crowd says nothing of the shape.
[[nodiscard]] ModelFaces model_faces(std::span<const PlacedScan> scans,
                                     std::span<const Eigen::Vector3f> vertices);

/// "the obverse", "the top edge": as an operator would say it.
[[nodiscard]] const char* spoken(Face face);

}  // namespace dubsar
