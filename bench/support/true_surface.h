// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/mesh.h"
#include "sim/tablet.h"

namespace dubsar::bench {

/// `scanned` with what made the nearest place of the true surface and whose wedge it is, at every vertex of a
/// mesh scanned from it; kHole where there is none within 1 mm. Its wedges are the true ones.
[[nodiscard]] sim::SimTablet with_truth(Mesh scanned, const sim::SimTablet& truth);

}  // namespace dubsar::bench
