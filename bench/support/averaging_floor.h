// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/sample_flags.h"

namespace dubsar::bench {

struct AveragingFloor {
  std::vector<double> residual_mm;  ///< [valid samples of all scans, in their order]
  std::size_t alone = 0;  ///< samples without a surface within reach, their own included: residual 0
};

/// What perfect averaging leaves between samples and surface: the distance of each sample, along the normal,
/// from the plain mean of the surfaces of all scans (its own among them) that pass within reach_mm of it and
/// face the same way. No single sheet through the middle of the scans lies closer to all of them. With a
/// short reach, surfaces that disagree by more count as met, each by itself: a floor that only two sheets,
/// one over the other, could reach.
[[nodiscard]] AveragingFloor averaging_floor(const std::vector<std::shared_ptr<const RangeGrid>>& grids,
                                             const std::vector<RigidTransform>& poses,
                                             const std::vector<SampleFlags>& flags, double reach_mm);

}  // namespace dubsar::bench
