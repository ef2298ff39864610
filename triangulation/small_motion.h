// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dubsar {

/// A rigid motion so small that its turn is linear. None as it comes.
struct SmallMotion {
  Eigen::Vector3f about_mm{0, 0, 0};
  Eigen::Vector3f turn_rad{0, 0, 0};  ///< rotation vector
  Eigen::Vector3f shift_mm{0, 0, 0};  ///< of about_mm

  [[nodiscard]] bool is_none() const { return turn_rad.isZero(0) && shift_mm.isZero(0); }
  [[nodiscard]] Eigen::Vector3f at(const Eigen::Vector3f& p_mm) const {
    return shift_mm + turn_rad.cross(p_mm - about_mm);
  }
  [[nodiscard]] bool operator==(const SmallMotion&) const = default;
  /// This one, and back the other.
  [[nodiscard]] SmallMotion operator-(const SmallMotion& other) const {
    if (is_none()) {
      return {other.about_mm, -other.turn_rad, -other.shift_mm};
    }
    return {about_mm, turn_rad - other.turn_rad, shift_mm - other.at(about_mm)};
  }
};

}  // namespace dubsar
