// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/placed_scan.h"
#include "core/red_map.h"

namespace dubsar {

/// The edge over which what was seen of a tablet is best joined to what was seen of its other side.
struct JoiningEdge {
  Face face = Face::kLeft;
  Eigen::Vector3d outward{1, 0, 0};  ///< out of the edge, model frame, unit
  Eigen::Vector3d seen{0, 0, 1};     ///< out of the side that was seen, likewise
};

/// Of the four edges around the obverse or reverse, whichever more was seen of, the one with most relief on
/// it and within a quarter of the tablet beside it, among those beyond which hardly anything was seen: scans
/// over that edge overlap with what tells a pose. Relief is what goes up and down along the edge within 1.5
/// mm, summed over it but for the corners: neither the bend of a rim nor a moulding that runs along it
/// counts. Nothing
/// where the other side was seen beyond all of them, or no surface is there.
[[nodiscard]] std::optional<JoiningEdge> joining_edge(std::span<const PlacedScan> model);

}  // namespace dubsar
