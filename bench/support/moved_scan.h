// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/range_grid.h"

namespace dubsar::bench {

/// How a tablet moves while it is scanned.
struct Move {
  Eigen::Vector3d turn_deg{0, 0, 0},
      shift_mm{0, 0, 0};  ///< scanner frame; the turn is about the scan's middle
  double after = 0.5;     ///< of the samples: the row of this one and all later ones are moved
  bool steadily = false;  ///< instead: from the first sample on, and the whole of it at the last
};

/// The grid as it would be had the tablet moved so.
[[nodiscard]] std::shared_ptr<const RangeGrid> moved_scan(const RangeGrid& still, const Move& move);

}  // namespace dubsar::bench
