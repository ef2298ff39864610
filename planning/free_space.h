// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/placed_scan.h"

namespace dubsar {

/// Space that holds nothing, for a camera looked through it: what lies on the line from a non-flagged sample
/// to the camera that saw it (space carving: Kutulakos and Seitz, A Theory of Shape by Space Carving, 2000).
/// In cells of the model frame, within a box.
class FreeSpace {
 public:
  /// Cells are made larger where the box would hold too many.
  FreeSpace(std::span<const PlacedScan> scans, const Eigen::AlignedBox3d& box_mm, double cell_mm);

  [[nodiscard]] double cell_mm() const { return cell_mm_; }
  /// False outside the box.
  [[nodiscard]] bool was_looked_through(const Eigen::Vector3d& p_mm) const;

 private:
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  [[nodiscard]] std::size_t cell_of(const Eigen::Vector3d& p_mm) const;
  void look_from(const PlacedScan& scan);

  Eigen::AlignedBox3d box_mm_;
  double cell_mm_;
  std::array<std::size_t, 3> count_{};
  std::vector<std::uint8_t> free_;  ///< by cell
};

}  // namespace dubsar
