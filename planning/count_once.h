// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/placed_scan.h"
#include "planning/red_targets.h"

namespace dubsar {

/// Counts clay once that a patch of the closing surface and the border of the hole before it both stand for:
/// of what hangs together (as red_regions() has it) the patches, and what borders them within border_mm and a
/// patch, have the larger of both areas together, and keep the same share of their own. What borders no patch
/// keeps its area.
void count_once(std::span<const PlacedScan> scans, double border_mm, RedTargets& red);

}  // namespace dubsar
