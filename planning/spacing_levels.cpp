// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/spacing_levels.h"

#include <algorithm>

#include "planning/clearing.h"

namespace dubsar {

namespace {

constexpr double kOneLevel = 1.25;
/// Of more the last one holds all that is coarser.
constexpr std::size_t kMostLevels = 32;

}  // namespace

SpacingLevels::SpacingLevels(std::span<const PlacedScan> scans) : of_scan_(scans.size(), 0) {
  std::vector<double> spacings;
  for (const PlacedScan& scan : scans) {
    spacings.push_back(spacing_of(*scan.grid));
  }
  std::vector<double> sorted(spacings);
  std::erase_if(sorted, [](double spacing_mm) { return !(spacing_mm > 0); });  // of a scan without samples
  std::ranges::sort(sorted);
  double finest_mm = 0;
  for (const double spacing_mm : sorted) {
    const bool is_next = spacing_mm > kOneLevel * finest_mm && spacing_mm_.size() < kMostLevels;
    if (spacing_mm_.empty() || is_next) {
      finest_mm = spacing_mm;
      spacing_mm_.push_back(spacing_mm);
    }
    spacing_mm_.back() = spacing_mm;
  }
  if (spacing_mm_.empty()) {
    spacing_mm_.push_back(0);
  }
  for (std::size_t s = 0; s < scans.size(); ++s) {
    of_scan_[s] =
        static_cast<std::uint8_t>(std::ranges::lower_bound(spacing_mm_, spacings[s]) - spacing_mm_.begin());
  }
}

}  // namespace dubsar
