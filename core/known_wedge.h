// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/wedge.h"

namespace dubsar {

/// A depth point that moved further than this when the mesh was made anew is not taken for the same one.
inline constexpr double kSamePlaceMm = 0.25;

/// An id that a wedge was told of by, and what that wedge is known again by.
struct KnownWedge {
  int id = 0;
  Eigen::Vector3d depth_point_mm{0, 0, 0};  ///< model frame
  ByHand by_hand = ByHand::kNo;
};

/// What an earlier measurement told: others may have cited these ids.
struct EarlierWedges {
  std::vector<KnownWedge> wedges;  ///< those that there were, and those that were gone by then
  /// Nobody knows whether they are of this tablet: then the places have to tell.
  bool may_be_others = false;
};

}  // namespace dubsar
