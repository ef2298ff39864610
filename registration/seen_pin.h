// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>

namespace dubsar {

/// A pin's tip as one scan shows it, or as several do (pin_merge.h).
struct SeenPin {
  int label = -1;                        ///< the operator's number, -1 when unlabelled
  Eigen::Vector3d position_mm{0, 0, 0};  ///< centre of the tip ball, scanner frame, or the model's
  Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  ///< of position_mm, as measured
  int placements = 1;  ///< whose mean this is: the error of putting back goes down with it
};

}  // namespace dubsar
