// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "core/red_map.h"

namespace dubsar {

/// What a wedge is compared by. Edges and faces are counted from the directional edge on, counter-clockwise,
/// so that the same stylus held the same way gives the same numbers whichever way the wedge points.
inline constexpr std::array<std::string_view, 11> kWedgeFeatures = {
    "depth_mm",
    "directional_length_mm",
    "second_length_mm",
    "third_length_mm",
    "directional_slope_deg",
    "directional_opening_deg",
    "second_opening_deg",
    "third_opening_deg",
    "first_face_angle_deg",
    "second_face_angle_deg",
    "third_face_angle_deg",
};
inline constexpr std::size_t kWedgeLengths = 4;  ///< so many of them, the first, are lengths; others angles
inline constexpr std::size_t kProfileQuantiles = 9;  ///< 0.1, 0.2 … 0.9

/// Kinds of wedges by the direction of their tail (facts.md, after Gottstein), besides the Winkelhaken.
inline constexpr std::array<std::string_view, 6> kWedgeKinds = {"horizontal", "vertical",    "downwards",
                                                                "upwards",    "winkelhaken", "other"};

/// How the features of some wedges are distributed: of a whole tablet, or of one side of it.
struct WedgeProfile {
  std::optional<Face> side;  ///< unset: the whole tablet
  int count = 0;
  int beyond_mesh = 0;  ///< inner edges before whose end the mesh ends: their lengths are in no quantile
  std::array<std::array<double, kProfileQuantiles>, kWedgeFeatures.size()> quantiles{};
  /// Of how many wedges the quantiles of each feature are. Not in files: it follows from their wedges.
  std::array<int, kWedgeFeatures.size()> known{};
  std::array<double, kWedgeKinds.size()> kinds{};  ///< shares
};

}  // namespace dubsar
