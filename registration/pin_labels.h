// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/pin_set.h"
#include "registration/seen_pin.h"

namespace dubsar {

/// The operator's tips, each moved onto the nearest detected one within the diameter and a millimetre (clicks
/// are good to 1 mm), nearest pairs first; clicks with no tip stay where they were made, with their own
/// uncertainty; detected tips that nobody labelled follow unlabelled.
[[nodiscard]] std::vector<SeenPin> labelled_tips(const std::vector<SeenPin>& detected,
                                                 const std::vector<PinTip>& clicked, double tip_diameter_mm);

}  // namespace dubsar
