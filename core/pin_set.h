// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

namespace dubsar {

/// The centre of one tip ball in a scan's own frame.
struct PinTip {
  int label = -1;  ///< the operator's number, -1 when unlabelled
  Eigen::Vector3d position_mm{0, 0, 0};
};

/// Fiducial pins (seed 001, 3.2). `tips` by scan id; a scan that is absent has unlabelled pins.
struct PinSet {
  double tip_diameter_mm = 1.0;
  std::map<int, std::vector<PinTip>> tips;
};

}  // namespace dubsar
