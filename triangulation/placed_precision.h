// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/range_grid.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/scan_pose.h"

namespace dubsar {

/// What of a grid tells whether float coordinates keep its samples, and what is stitched of them, apart where
/// a pose puts it.
class PlacedPrecision {
 public:
  explicit PlacedPrecision(const RangeGrid& grid);

  /// kBadInput when the pose puts it too far from the origin of the model. `name` is the scan's for people.
  [[nodiscard]] Status check(const RigidTransform& model_from_scanner, const std::string& name) const;
  /// The pose as the model can hold it: one that is registered too far away is failed, and says why.
  [[nodiscard]] ScanPose judged(ScanPose pose) const;

 private:
  Eigen::Vector3d middle_mm_;  ///< of the samples, scanner frame
  double spacing_mm_;
};

}  // namespace dubsar
