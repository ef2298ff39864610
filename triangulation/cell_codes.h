// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>

#include "core/row_camera.h"
#include "triangulation/grid_triangulation.h"

namespace dubsar {

/// The tests a triangle has to pass, with all constants of the grid at hand.
struct TriangleTest {
  float max_edge2 = 0;
  float min_facing2 = 0;
  float min_shape2 = 0;
  float sign = 1;  ///< -1 for a mirrored grid

  TriangleTest(double spacing_mm, bool mirrored, const GridTriangulationOptions& options);
};

/// A grid as it was scanned, with its normals.
struct GridSamples {
  const RangeGrid* grid;
  std::span<const Eigen::Vector3f> normals;
};

/// CellBit codes of `count` cells of a row from `col` on, or of a whole row. Many at a time, without a
/// branch: several times as fast as cell by cell.
void cell_codes(const GridSurface& surface, std::span<const std::uint8_t> keep, int row, int col, int count,
                const RowCamera& camera, const TriangleTest& good, std::uint8_t* out);
void cell_codes(const GridSamples& samples, std::span<const std::uint8_t> keep, int row,
                const RowCamera& camera, const TriangleTest& good, std::uint8_t* out);

}  // namespace dubsar
