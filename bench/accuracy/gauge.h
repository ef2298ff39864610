// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/rigid_transform.h"
#include "core/scan_pose.h"

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

/// Squared error of a pose against the truth in parts of its covariance, per degree of freedom: 1 on average
/// when the covariance is what it claims. The true pose must be in the model frame as registration fixes it
/// (the first scan is exact).
[[nodiscard]] double normalised_error(const ScanPose& pose, const RigidTransform& model_from_scanner_true,
                                      const Eigen::Vector3d& centroid_mm);

}  // namespace dubsar::accuracy
