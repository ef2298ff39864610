// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_histogram.h"

#include <algorithm>
#include <cmath>

#include "analysis/wedge_features.h"

namespace dubsar {

WedgeHistogram histogram_of(const std::vector<Wedge>& wedges, std::size_t feature, std::size_t bins) {
  WedgeHistogram out{0, 0, std::vector<float>(bins, 0.0F)};
  std::vector<double> values;
  values.reserve(wedges.size());
  for (const Wedge& wedge : wedges) {
    if (const double value = wedge_features(wedge).at(feature); !std::isnan(value)) {
      values.push_back(value);
    }
  }
  if (values.empty() || bins == 0) {
    return out;
  }
  const auto [least, most] = std::ranges::minmax(values);
  out.least = least;
  out.most = most;
  for (const double value : values) {
    const double part = most > least ? (value - least) / (most - least) : 0.0;
    out.bins[std::min(bins - 1, static_cast<std::size_t>(part * static_cast<double>(bins)))] += 1;
  }
  return out;
}

}  // namespace dubsar
