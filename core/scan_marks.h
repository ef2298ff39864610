// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// A sample that stands out of the surface more than all others around it, and what it and its eight
/// neighbours look like: second differences and twists, mm, each divided by the length of its coefficients,
/// so that noise and rounding show in it as much as in one coordinate. The same when the grid is moved,
/// transposed or reversed.
struct ScanMark {
  Eigen::Vector3f at_mm{0, 0, 0};  ///< in the scanner frame
  std::array<float, 6> shape{};    ///< the first: how far it stands out
  bool is_inside = false;          ///< nothing is missing around it: no edge has made it a mark
};

/// Some per cent of a grid's samples, by which they are known again in whatever form they come: noise shapes
/// them, and no two scans have the same.
struct ScanMarks {
  std::vector<ScanMark> marks;  ///< by how far they stand out, the least first
  double spacing_mm = 0;        ///< the larger of the median steps along rows and along columns
  /// What two copies may differ by, RMS of one coordinate: rounding, well below noise.
  double rounding_mm = 0;
  double least_mm = 0;  ///< what stands out less is no mark
};

/// None where nothing stands out more than rounding makes it: of planes and smooth shapes without noise.
/// Linear in samples.
[[nodiscard]] ScanMarks scan_marks(const RangeGrid& grid);

}  // namespace dubsar
