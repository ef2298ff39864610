// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

namespace dubsar {

struct FreeSurfaceOptions {
  /// 0: from the mesh itself, automatic_openness(). What an open place reads depends on noise and resolution
  /// (clean and fine 0.99, scanned with 20 µm of noise 0.95).
  float least_openness = 0;
  float most_concave_per_mm = 0.5F;  ///< mean curvature below minus this is concave
  float scale_mm = 0.3F;             ///< at which the curvature is taken
};

/// Kept a little below what the openest fifth of the vertices reach: there is that much free surface left on
/// the densest tablet.
[[nodiscard]] float automatic_openness(const std::vector<float>& openness);

/// 1 where a vertex belongs to the wedge-free surface, mostly convex and little curved (seed 000, 3.2):
/// open, and not concave beyond the threshold. [V]
[[nodiscard]] std::vector<std::uint8_t> find_free_surface(const std::vector<float>& openness,
                                                          const std::vector<float>& mean_curvature_per_mm,
                                                          const FreeSurfaceOptions& options);

}  // namespace dubsar
