// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/rig_calibration.h"

namespace dubsar {

/// How far points reach along a plane, in directions a degree apart, less the few that stray (1.5 in a
/// thousand at each end).
class PlaneOutline {
 public:
  PlaneOutline(const Plane& plane, const std::vector<Eigen::Vector3d>& points_mm);
  /// Sides of the smallest rectangle in the plane that holds the points; longer first.
  [[nodiscard]] std::array<double, 2> sides_mm() const;
  /// The point lies, seen along the normal, within nine tenths of every width: the last samples at an edge
  /// are seldom good.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point_mm) const;

 private:
  struct Width {
    Eigen::Vector3d direction;
    double low_mm = 0;
    double high_mm = 0;
    [[nodiscard]] double mm() const { return high_mm - low_mm; }
  };
  std::vector<Width> widths_;  ///< over half a turn
};

}  // namespace dubsar
