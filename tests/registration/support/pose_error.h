// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <utility>

#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/scan_pose.h"

namespace dubsar::testing {

inline std::shared_ptr<const RangeGrid> share(RangeGrid grid) {
  return std::make_shared<const RangeGrid>(std::move(grid));
}

/// How far places of a scan lie from where they should, where the first one is right, mm.
inline double error_mm(const ScanPose& pose, const ScanPose& first, const RigidTransform& truth,
                       const RigidTransform& first_truth) {
  const RigidTransform mine = first.model_from_scanner.inverse() * pose.model_from_scanner;
  const RigidTransform theirs = first_truth.inverse() * truth;
  double worst = 0;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(20, 0, 0), Eigen::Vector3d(0, 20, 0), Eigen::Vector3d(-20, -20, 0)}) {
    worst = std::max(worst, (mine * p - theirs * p).norm());
  }
  return worst;
}

}  // namespace dubsar::testing
