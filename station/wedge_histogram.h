// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <vector>

#include "core/wedge.h"
#include "core/wedge_profile.h"

namespace dubsar {

/// How many wedges have so much of a feature: bins of equal width from the least to the most.
struct WedgeHistogram {
  double least = 0;  ///< in the unit that the feature's name says
  double most = 0;
  std::vector<float> bins;
};

/// `feature`: index into kWedgeFeatures. All bins are empty where there is no wedge.
[[nodiscard]] WedgeHistogram histogram_of(const std::vector<Wedge>& wedges, std::size_t feature,
                                          std::size_t bins);

}  // namespace dubsar
