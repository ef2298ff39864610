// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/placed_scan.h"
#include "core/sample_states.h"
#include "planning/red_targets.h"

namespace dubsar {

/// The state of every sample of a scan. flags: of the scan, as make_red_map() gives them; cleared_by: as
/// ClearedMap::cleared_by() gives it; position: of the scan in the span that `red` was made of.
[[nodiscard]] SampleStates sample_states(const RangeGrid& grid, const SampleFlags& flags,
                                         const std::vector<int>& cleared_by, const RedTargets& red,
                                         std::uint32_t position);

/// A target that lacks no surface: returns from nowhere.
[[nodiscard]] bool is_stray(const RedTarget& target);

}  // namespace dubsar
