// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/rigid_transform.h"

namespace dubsar::sim {

/// One view of a tablet held before the scanner.
struct PlannedView {
  std::string name;
  RigidTransform tablet_from_scanner;  ///< true, the hand's error included
};

/// Views for a tablet that is turned by hand: both faces first, then around the rim, from above and from
/// below in turn, overlapping their neighbours; twelve or more cover a tablet. Each is off what would be
/// regular by up to 10 degrees and 5 mm. The same seed gives the same views; count < 1 gives none.
[[nodiscard]] std::vector<PlannedView> plan_views(int count, std::uint64_t seed);

}  // namespace dubsar::sim
