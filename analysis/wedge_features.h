// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <vector>

#include "core/wedge.h"
#include "core/wedge_profile.h"

namespace dubsar {

using WedgeFeatures = std::array<double, kWedgeFeatures.size()>;

/// The features by the names and units of kWedgeFeatures. No number for the length of an edge that the mesh
/// ends before.
[[nodiscard]] WedgeFeatures wedge_features(const Wedge& wedge);

/// The same on scales on which a step of one is about what one hand's wedges scatter by (lengths by their
/// logarithm): for distances between wedges.
/// An edge that the mesh ends before is as long as its depth and slope say, which clay that is there gives.
[[nodiscard]] std::vector<float> comparable(const Wedge& wedge);

/// Index into kWedgeKinds.
[[nodiscard]] std::size_t kind_of(const Wedge& wedge);

/// Of the whole tablet, then of each side that has wedges. Quantiles are of the numbers that are known: 0
/// where there are none.
[[nodiscard]] std::vector<WedgeProfile> make_profiles(const std::vector<Wedge>& wedges);

/// The same for a page to be read: slopes, opening and face angles are those of wedges of which they can be
/// read (docs/scholars/measurements.md), intact kLeastIntact and more and worn to no more than
/// kMostRoundness; what is not known of a wedge speaks against it.
[[nodiscard]] std::vector<WedgeProfile> make_read_profiles(const std::vector<Wedge>& wedges);
inline constexpr double kLeastIntact = 0.8;
inline constexpr double kMostRoundness = 0.02;
/// Whether this is such a wedge.
[[nodiscard]] bool has_readable_angles(const Wedge& wedge);

/// Quantiles of all features of these wedges on their comparable scales, of comparable() of each: the L1
/// distance of two is the mean distance that the one's wedges would have to be shifted by to be distributed
/// as the other's (Wasserstein), summed over the features. Empty of no wedges.
[[nodiscard]] std::vector<float> comparable(const std::vector<Wedge>& wedges);

}  // namespace dubsar
