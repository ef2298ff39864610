// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/body.h"

namespace dubsar::sim {

/// A cylinder seal rolled across the reverse: a band of figures between two lines, repeated once a turn.
class SealBand {
 public:
  SealBand(const TabletBody& body, double relief_mm, std::uint64_t seed);
  /// Height of the relief over the base point p with normal n; 0 outside the band.
  [[nodiscard]] double height_mm(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const;
  /// Whether p lies within the band.
  [[nodiscard]] bool covers(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const;

 private:
  double relief_mm_;
  double middle_y_ = 0;
  double half_height_ = 5;
  double turn_mm_ = 16;  ///< circumference of the seal
  double shift_mm_ = 0;
  double tilt_ = 0;
};

}  // namespace dubsar::sim
