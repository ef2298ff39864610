// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/wedge.h"
#include "core/wedge_profile.h"

namespace dubsar {

/// How many wedges have so much of a feature: bins of equal width from the least to the most.
struct WedgeHistogram {
  double least = 0;  ///< in the unit that the feature's name says
  double most = 0;
  std::vector<float> bins;
  std::string note;  ///< of how many wedges it is, and why; empty: of all
};

/// `feature`: index into kWedgeFeatures. Slopes, opening and face angles are those of wedges that they can be
/// read of (has_readable_angles()). All bins are empty where there is none.
[[nodiscard]] WedgeHistogram histogram_of(const std::vector<Wedge>& wedges, std::size_t feature,
                                          std::size_t bins);

}  // namespace dubsar
