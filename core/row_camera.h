// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>

#include "core/range_grid.h"

namespace dubsar {

/// The camera as one row of a grid has it: worked out once for all its samples.
class RowCamera {
 public:
  RowCamera(const ScannerView& view, int row)
      : at_(view.camera_mm ? Eigen::Vector3f((*view.camera_mm + row * view.motion_per_row_mm).cast<float>())
                           : Eigen::Vector3f(-view.direction.cast<float>())),
        known_(view.camera_mm.has_value()) {}

  /// Towards the camera from p, not normalised; against the viewing direction where its place is not known.
  [[nodiscard]] Eigen::Vector3f from(const Eigen::Vector3f& p_mm) const {
    return known_ ? Eigen::Vector3f(at_ - p_mm) : at_;
  }

  /// Its place; the direction towards it where that is not known.
  [[nodiscard]] const Eigen::Vector3f& at() const { return at_; }
  [[nodiscard]] bool is_known() const { return known_; }

 private:
  Eigen::Vector3f at_;
  bool known_;
};

}  // namespace dubsar
