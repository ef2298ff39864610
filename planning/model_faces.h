// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/placed_scan.h"
#include "core/red_map.h"

namespace dubsar {

/// How the six faces lie in the model frame: columns are the directions of the right edge (x), the top edge
/// (y) and the obverse (z).
///
/// Where a scan came with a nominal pose, its tablet frame says so: the frame of the registered scan of the
/// lowest id. Otherwise the faces follow from the shape: the thickness is the smallest extent, the height the
/// largest; the obverse is the side that the first scan looked at, and up is the first scan's y axis or x
/// axis, whichever runs along the height.
struct ModelFaces {
  Eigen::Matrix3d model_from_faces = Eigen::Matrix3d::Identity();

  [[nodiscard]] Eigen::Vector3d normal(Face face) const;
  /// The face that a surface with this outward normal belongs to.
  [[nodiscard]] Face of(const Eigen::Vector3d& normal) const;
};

/// points: of the model's hull or surface, for the extents.
[[nodiscard]] ModelFaces model_faces(std::span<const PlacedScan> scans,
                                     std::span<const Eigen::Vector3d> points);

/// "the obverse", "the top edge": as an operator would say it.
[[nodiscard]] const char* spoken(Face face);

}  // namespace dubsar
