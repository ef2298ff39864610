// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/rigid_transform.h"

namespace dubsar::accuracy {

/// A scan's points in its own frame with the two poses to compare.
struct PosePair {
  std::vector<Eigen::Vector3d> points_mm;
  RigidTransform truth_from_scanner;
  RigidTransform model_from_scanner;
};

/// The one rigid transform (the gauge) that best takes the model frame to the truth frame, over all points of
/// all scans (Horn 1987 by SVD, Arun et al. 1987).
[[nodiscard]] RigidTransform truth_from_model(const std::vector<PosePair>& pairs);

/// What is left of one scan's pose after the gauge.
struct PoseError {
  double rotation_rad = 0;
  double centroid_mm = 0;  ///< displacement of the scan's centroid
  double rms_mm = 0;       ///< displacement over its points
  std::vector<double> displacements_mm;
};
[[nodiscard]] PoseError pose_error(const PosePair& pair, const RigidTransform& gauge);

}  // namespace dubsar::accuracy
