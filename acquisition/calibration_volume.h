// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>

#include "core/camera_model.h"

namespace dubsar {

/// Standard deviation of a point in the measuring volume against the others, the largest, mm. `unknowns` are
/// fx fy cx cy k1 k2 p1 p2 k3, the laser plane's normal over its distance, the stage's direction (15),
/// `joint` their covariance (15 x 15). The rigid motion of all points together, which no measurement can see,
/// is taken out. `linear`: the direction is that of a slide and counts.
[[nodiscard]] double volume_sigma_mm(const CameraModel& camera, const Eigen::VectorXd& unknowns,
                                     const Eigen::MatrixXd& joint, bool linear, double depth_range_mm);

}  // namespace dubsar
