// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "triangulation/pose_step.h"

namespace dubsar {

/// Two scans, by their place in a list, and how their poses hold them against each other.
struct PoseLink {
  std::size_t a = 0, b = 0;
  PoseStep step;
};

/// How each scan's pose seems to be off: from the motions of all scans that explain the steps between them
/// best, of these the ones that move as few scans as possible, and none that is fixed. Nothing where that
/// does not stand well above its own error, or is a small part of the spacing. A pass of a stage may stand
/// for its scan. The order of `links` decides about rounding alone.
[[nodiscard]] std::vector<Misplacement> misplacements(std::span<const StitchSurface* const> scans,
                                                      std::span<const PoseLink> links);

}  // namespace dubsar
