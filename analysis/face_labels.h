// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/wedge_patch.h"

namespace dubsar {

/// Cleans the clusters of a wedge's faces (seed 000, 3.4). Anti-spike filter: a vertex of which most
/// neighbours agree on another label takes that. Closing, then opening, by one ring. Parts of a face smaller
/// than a tenth of it are taken away. face: [N], 0 to 2 or -1.
void clean_labels(const WedgePatch& patch, std::vector<std::int8_t>* face);

}  // namespace dubsar
