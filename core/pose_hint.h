// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar {

/// The same place of the clay, clicked in two scans; good to about 1 mm.
struct PointPair {
  Eigen::Vector3d point_mm{0, 0, 0};     ///< in the frame of the scan that the hint is for
  Eigen::Vector3d on_point_mm{0, 0, 0};  ///< in the frame of the scan `on`
};

/// What the operator says of where a scan lies: against another scan, so that it stays true whatever becomes
/// of the model's frame. Either points (three or more give the pose; one or two choose among the poses that
/// fit) or a rough pose.
struct PoseHint {
  int on = -1;  ///< id of the other scan
  std::vector<PointPair> points;
  std::optional<RigidTransform> on_from_scanner;  ///< good to some degrees and millimetres
};

}  // namespace dubsar
