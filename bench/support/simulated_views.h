// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <vector>

#include "core/placed_scan.h"
#include "core/range_grid.h"
#include "core/sample_flags.h"

namespace dubsar::bench {

/// Scans of a simulated tablet with their nominal poses (as a hand turn leaves them), true poses and flags,
/// made once and shared by the benchmarks.
struct SimulatedViews {
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  std::vector<SampleFlags> flags;
  std::vector<RigidTransform> poses;
  [[nodiscard]] std::vector<PlacedScan> placed() const;
  [[nodiscard]] std::size_t samples() const;  ///< valid ones, of all scans
};

/// `count` views of a 60 x 50 x 22 mm tablet; about a million samples each at 0.05 mm, with 0.02 mm noise.
[[nodiscard]] const SimulatedViews& million_sample_views(int count);

/// Eleven views of a 70 x 60 x 24 mm tablet, the last one of `millions` (1 or 4) of samples or a few more,
/// the noise 0.4 µ. Only the last set asked for is kept.
[[nodiscard]] const SimulatedViews& views_of_millions(int millions);

/// The same tablet from `count` views of `millions` of samples each, the noise 0.4 µ. Not kept.
[[nodiscard]] SimulatedViews make_views_of_millions(int count, double millions);

}  // namespace dubsar::bench
