// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/sample_flags.h"

namespace dubsar {

/// A scan that is in its place: what planning and triangulation work on. Refers to the grid and its flags,
/// owns neither.
struct PlacedScan {
  int id = 0;
  const RangeGrid* grid = nullptr;
  const SampleFlags* flags = nullptr;  ///< as long as the grid
  RigidTransform model_from_scanner;
  double sigma_mm = 0;  ///< of the pose
  /// Of one sample along the view (grid_noise.h), where somebody has estimated it already.
  std::optional<double> noise_mm = std::nullopt;
  bool is_fixed =
      false;  ///< the operator locked its pose: others are laid against it, it is not laid elsewhere
};

}  // namespace dubsar
