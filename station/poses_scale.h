// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// Whether the translations of poses are in the unit of their scans: lengths a thousand times too small or
/// too large put scans apart that belong together. Keeps a few hundred samples of each.
class PosesScale {
 public:
  void add(const RangeGrid& grid, const RigidTransform& model_from_scanner);
  /// What to say after the name of the file that the poses are of, where the scans would fall together
  /// with translations 1000 times as long, or as short, and do not with these. Empty where they would not.
  [[nodiscard]] std::string fault() const;

 private:
  struct One {
    std::vector<Eigen::Vector3d> turned_mm;  ///< samples, rotated as the pose has it, and not moved
    Eigen::Vector3d translation_mm;
  };
  [[nodiscard]] double together(double scale) const;

  std::vector<One> scans_;
  double size_mm_ = 0;  ///< of the largest
};

}  // namespace dubsar
