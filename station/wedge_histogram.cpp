// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_histogram.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/wedge_features.h"

namespace dubsar {

namespace {

constexpr const char* kOfReadable = "angles are read where a wedge is known to be whole and sharp";
constexpr const char* kOfKnown = "of the others the mesh ends before the edge does";

}  // namespace

WedgeHistogram histogram_of(const std::vector<Wedge>& wedges, std::size_t feature, std::size_t bins) {
  WedgeHistogram out{0, 0, std::vector<float>(bins, 0.0F), {}};
  const bool is_angle = feature >= kWedgeLengths;
  std::vector<double> values;
  values.reserve(wedges.size());
  for (const Wedge& wedge : wedges) {
    const double value = wedge_features(wedge).at(feature);
    if (!std::isnan(value) && (!is_angle || has_readable_angles(wedge))) {
      values.push_back(value);
    }
  }
  if (values.size() < wedges.size()) {
    out.note = fmt::format("{} / {}: {}", values.size(), wedges.size(), is_angle ? kOfReadable : kOfKnown);
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
