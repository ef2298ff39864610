// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "sim/scene.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// What a sample of a simulated scan was measured on.
enum class SampleTruth : std::uint8_t {
  kNothing,  ///< no return
  kClay,
  kPin,        ///< ball, cone or arm
  kStrayClay,  ///< a reflection, or a mixture of two depths, whose ray met clay
  kStrayPin,   ///< the same, whose ray met a pin
};

/// A scan in which pins stand, with what is true of it.
struct PinnedScan {
  RangeGrid grid;
  RigidTransform tablet_from_scanner;
  std::vector<sim::Pin> pins;      ///< that stood in this scan, as put back for it, scanner frame
  std::vector<SampleTruth> truth;  ///< [rows*cols]
};

struct PinnedScanOptions {
  double spacing_mm = 0.1;
  double noise_mm = 0.02;
  double tip_diameter_mm = 1.0;
  int views = 12;
  std::uint64_t seed = 1;
};

/// Scans the tablet with its pins from plan_views(views); exits the program when it cannot.
[[nodiscard]] std::vector<PinnedScan> pinned_scans(const sim::TabletOptions& tablet,
                                                   const PinnedScanOptions& options);

/// Samples of a pin's own ball, the half away from its arm, that the scan shows in place.
[[nodiscard]] int ball_samples(const PinnedScan& scan, const sim::Pin& pin);

}  // namespace dubsar::bench
