// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/owned_scan.h"

namespace dubsar {

/// Takes away patches (kept samples around cells with triangles) of fewer than `least` samples, of those that
/// hold one of the samples with starts != 0.
void remove_specks(std::vector<std::uint8_t>& kept, const std::vector<std::uint8_t>& cells,
                   const std::vector<std::uint8_t>& starts, const Lattice& grid, int least);

/// Takes back those of the fresh samples that will not be part of a patch of `least` samples, whatever
/// triangles there are between them: fresh and kept samples beside each other are fewer. `kept` may be empty:
/// none.
void drop_scattered(std::vector<std::uint8_t>& fresh, std::span<const std::uint8_t> kept, const Lattice& grid,
                    int least);

/// Takes away the triangles that lack a corner, then the samples that no triangle uses; and brings what the
/// scan tells others of its patches (near_kept, some_kept, all_kept) up to date.
void settle_patches(OwnedScan& scan);

}  // namespace dubsar
