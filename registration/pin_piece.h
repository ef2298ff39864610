// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/range_grid.h"
#include "registration/pin_components.h"

namespace dubsar {

/// A component of a grid that is parted at its depth steps: perhaps a pin's arm, perhaps clay.
struct GridPiece {
  std::vector<std::uint32_t> samples;
  std::vector<Eigen::Vector3d> points_mm;
  Eigen::Vector3d to_camera{0, 0, 1};
};

[[nodiscard]] GridPiece piece_of(const RangeGrid& grid, const Sheets& sheets, std::size_t component);

/// Samples of the piece at the border of the field.
[[nodiscard]] int at_border(const RangeGrid& grid, const std::vector<std::uint32_t>& samples);

/// Share of the piece's samples that no other component with large[c] != 0 comes near: clay that wedges and
/// their shadows cut off from the rest still lies among it, while an arm runs away from it.
[[nodiscard]] double standing_clear(const RangeGrid& grid, const Sheets& sheets,
                                    const std::vector<std::uint8_t>& large, const GridPiece& piece,
                                    double clear_mm, double spacing_mm);

}  // namespace dubsar
