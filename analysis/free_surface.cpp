// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/free_surface.h"

#include <algorithm>
#include <iterator>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

constexpr double kOpenShare = 0.2;
constexpr float kBelowOpen = 0.06F;
constexpr float kLeastThreshold = 0.5F;

}  // namespace

float automatic_openness(const std::vector<float>& openness) {
  // A vertex of no face reads 0.
  std::vector<float> sorted;
  std::ranges::copy_if(openness, std::back_inserter(sorted), [](float o) { return o > 0; });
  if (sorted.empty()) {
    return kLeastThreshold;
  }
  const auto rank = static_cast<std::size_t>((1.0 - kOpenShare) * static_cast<double>(sorted.size() - 1));
  return std::max(kLeastThreshold, value_at_rank(sorted, rank) - kBelowOpen);
}

std::vector<std::uint8_t> find_free_surface(const std::vector<float>& openness,
                                            const std::vector<float>& mean_curvature_per_mm,
                                            const FreeSurfaceOptions& options) {
  const float least = options.least_openness > 0 ? options.least_openness : automatic_openness(openness);
  std::vector<std::uint8_t> is_free(openness.size());
  parallel_for_each_index(
      openness.size(),
      [&](std::size_t i) {
        is_free[i] = openness[i] >= least && mean_curvature_per_mm[i] >= -options.most_concave_per_mm ? 1 : 0;
      },
      1U << 15U);
  return is_free;
}

}  // namespace dubsar
