// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/placed_scan.h"
#include "core/result.h"

namespace dubsar {

/// kBadInput when the scan's pose puts it so far from the origin of the model that float coordinates would
/// not keep its samples, nor what is stitched of them, apart. `name` is the scan's for people.
[[nodiscard]] Status check_placed_precision(const PlacedScan& scan, const std::string& name);

}  // namespace dubsar
