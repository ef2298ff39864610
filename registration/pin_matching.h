// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/seen_pin.h"

namespace dubsar {

struct PinMatchOptions {
  double sigma_mm = 0.3;         ///< of a tip per axis, each time pins are put back
  double distance_sigmas = 3.0;  ///< mutual distances that differ by more are not the same two pins
  double outlier_sigmas = 3.5;   ///< of a tip's residual; beyond, the pin was put back wrong or mislabelled
  int least_labelled = 3;        ///< matched pins that settle a pose when they carry labels
  int least_unlabelled = 4;      ///< without: three distances coincide too easily
};

struct PinMatch {
  RigidTransform target_from_source;
  std::vector<std::pair<int, int>> pairs;  ///< indices into source and target
  double rms_mm = 0;
};

/// Matches the tips of two scans by their labels where both carry any, else by mutual distances (the largest
/// set of pairs whose distances agree), and solves by Horn with outliers rejected. A first pose for ICP,
/// never the last. Nothing when too few agree, they lie on a line, or two sets agree equally well.
[[nodiscard]] std::optional<PinMatch> match_pins(const std::vector<SeenPin>& source,
                                                 const std::vector<SeenPin>& target,
                                                 const PinMatchOptions& options);

}  // namespace dubsar
