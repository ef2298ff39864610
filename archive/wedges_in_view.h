// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "archive/raster.h"
#include "core/red_map.h"
#include "core/wedge.h"

namespace dubsar {

/// A wedge on a picture: the triangle of its outer edges.
struct WedgeOnPicture {
  std::size_t wedge = 0;                        ///< position in the list of wedges
  std::array<Eigen::Vector2d, 3> corners_px{};  ///< from the picture's upper left corner, right and down
  /// On a picture of several views: the one that shows it here. A wedge near an edge is in two of them.
  std::optional<Face> view{};
};

/// Those wedges that a picture with this framing shows, in their order: they look at the viewer (their
/// surface is seen at no less than 15 degrees), and of the three corners at least two are hidden by nothing.
[[nodiscard]] std::vector<WedgeOnPicture> wedges_in_view(const std::vector<Wedge>& wedges,
                                                         const RenderScene& scene, const ViewCamera& camera,
                                                         const Framing& framing);

}  // namespace dubsar
