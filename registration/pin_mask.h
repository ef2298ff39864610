// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/range_grid.h"
#include "registration/pin_arm.h"
#include "registration/pin_components.h"

namespace dubsar {

/// Marks what is left of an arm that is hidden but for a corner: pieces that nothing connects with clay and
/// that reach the border of the field, or have nothing but arms around them. Clay that shadows cut into
/// pieces has more of its pieces near.
void mask_remnants(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& clay,
                   const std::vector<std::optional<PinArm>>& found, double far_mm, double spacing_mm,
                   std::vector<std::uint8_t>& mask);

/// Marks the arms, what lies in their envelopes and is no part of a large thing, and single samples beside
/// them that hang on to nothing else.
void fill_mask(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& large,
               const std::vector<std::uint8_t>& clay, const std::vector<PinArm>& arms, const PinScale& scale,
               std::vector<std::uint8_t>& mask);

}  // namespace dubsar
