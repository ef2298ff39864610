// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "core/range_grid.h"
#include "core/scan_copy.h"

namespace dubsar {

/// What tells a measurement from any other: the valid samples of a grid and their cells, bit by bit; not
/// their confidence, nor what else a file says of them. Against chance, not against anybody.
struct SampleDigest {
  std::uint64_t across = 0;  ///< of x and y
  std::uint64_t along = 0;   ///< of z and the cells

  auto operator<=>(const SampleDigest&) const = default;
};

/// Nothing of a grid without a valid sample, which measures nothing.
[[nodiscard]] std::optional<SampleDigest> sample_digest(const RangeGrid& grid);

/// By id; all but the first of those with the same samples. `samples` by scan.
[[nodiscard]] std::vector<ScanCopy> copies_among(const std::map<int, std::optional<SampleDigest>>& samples);
[[nodiscard]] std::vector<ScanCopy> copies_among(std::span<const PlacedScan> scans);

}  // namespace dubsar
