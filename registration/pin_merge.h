// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/seen_pin.h"

namespace dubsar {

/// A registered scan's tips.
struct PlacedPins {
  std::vector<SeenPin> tips;  ///< scanner frame
  RigidTransform model_from_scanner;
  /// Where the same samples are in several scans, as in one and its parts: a number that these share. Nothing
  /// for a scan by itself.
  std::optional<int> measured_as = {};
};

/// The pins of a model, in its frame: tips of different scans that lie within reach_mm of each other are one
/// pin, whose place is the weighted mean, so that putting back matters less with every scan; it takes the
/// label that most of them carry (the lowest of several). What was measured once counts once, as it came
/// first. In the order in which they were first seen.
[[nodiscard]] std::vector<SeenPin> merged_pins(std::span<const PlacedPins> scans, double reach_mm = 1.5);

}  // namespace dubsar
