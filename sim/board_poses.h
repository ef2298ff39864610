// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/rig_calibration.h"
#include "core/rigid_transform.h"

namespace dubsar::sim {

/// camera_from_board as an operator holds a board whose pattern reaches from low_mm to high_mm: tilted by 20
/// to 40° to every side in turn, near and far, moved about in the field. The same seed gives the same poses.
[[nodiscard]] std::vector<RigidTransform> board_poses(const RigCalibration& rig,
                                                      const Eigen::Vector2d& low_mm,
                                                      const Eigen::Vector2d& high_mm, int count,
                                                      std::uint64_t seed);

/// A board that lies on the stage, tilted by 20°, seen with the stage at each of the positions.
[[nodiscard]] std::vector<RigidTransform> carried_board(const RigCalibration& rig,
                                                        const Eigen::Vector2d& low_mm,
                                                        const Eigen::Vector2d& high_mm,
                                                        const std::vector<double>& positions);

}  // namespace dubsar::sim
