// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/placed_scan.h"

namespace dubsar {

/// The scans by their µ, the finest first. Spacings within a quarter of the finest of a level are one level,
/// and count as the coarsest of them. What counts as a gap is a matter of the place: the level of the scans
/// that sampled it (SurfaceCover), never that of a coarse scan that looked elsewhere.
class SpacingLevels {
 public:
  explicit SpacingLevels(std::span<const PlacedScan> scans);

  /// At least one; of no scans, the only level has the spacing 0.
  [[nodiscard]] std::size_t size() const { return spacing_mm_.size(); }
  [[nodiscard]] double spacing_mm(std::size_t level) const { return spacing_mm_[level]; }
  [[nodiscard]] double coarsest_mm() const { return spacing_mm_.back(); }
  [[nodiscard]] std::uint8_t of_scan(std::size_t scan) const { return of_scan_[scan]; }

 private:
  std::vector<double> spacing_mm_;     ///< ascending
  std::vector<std::uint8_t> of_scan_;  ///< [scans]
};

}  // namespace dubsar
