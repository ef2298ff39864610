// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

#include "core/mesh.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// A tablet of another make than sim/'s, so that nothing is fitted to that: a bun inscribed on one side by a
/// stylus with a rounded, slightly hollow-ground corner, wedges of very different size from tablet to tablet,
/// heads askew, clay pushed up on one side, broken at a corner, worn and rough.
struct OtherTabletOptions {
  std::uint64_t seed = 1;
  double spacing_mm = 0.1;
  double wear = 0.5;        ///< 0 to 1: roughness, rounding, the broken corner
  double noise_mm = 0.004;  ///< of each vertex
};

/// Mesh and wedges alone; `intact` as sim/ counts it.
[[nodiscard]] sim::SimTablet make_other_tablet(const OtherTabletOptions& options);

}  // namespace dubsar::bench
