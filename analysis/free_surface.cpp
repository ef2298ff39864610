// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/free_surface.h"

#include "core/parallel.h"

namespace dubsar {

std::vector<std::uint8_t> find_free_surface(const std::vector<float>& openness,
                                            const std::vector<float>& mean_curvature_per_mm,
                                            const FreeSurfaceOptions& options) {
  std::vector<std::uint8_t> is_free(openness.size());
  parallel_for_each_index(
      openness.size(),
      [&](std::size_t i) {
        is_free[i] =
            openness[i] >= options.least_openness && mean_curvature_per_mm[i] >= -options.most_concave_per_mm
                ? 1
                : 0;
      },
      1U << 15U);
  return is_free;
}

}  // namespace dubsar
