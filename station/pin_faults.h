// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/pin_set.h"
#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// Why the tips that `pins` has of a scan cannot be in it: they lie far outside, none of them is near a
/// sample, or they are closer together than balls of their size can be, as in another unit. `name` is
/// the scan's, in the error. Nothing where they may be right.
[[nodiscard]] std::optional<Error> misplaced_tips(const PinSet& pins, int id, const RangeGrid& measured,
                                                  const std::string& name);

/// The scans that the pins name and that are none of `ids`, in one error about `pins_file`.
[[nodiscard]] std::optional<Error> tips_of_no_scan(const PinSet& pins, std::span<const int> ids,
                                                   const std::string& pins_file);

}  // namespace dubsar
