// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/range_grid.h"
#include "core/sample_flags.h"

namespace dubsar {

struct GridTriangulationOptions {
  /// Longest edge, × µ. Seed 001, 3.3 calls neighbours beyond 3µ under-sampled; a diagonal is a little
  /// longer.
  double max_edge_factor = 3.5;
  /// A triangle whose normal is farther than this from the direction to the camera is a sliver between two
  /// surfaces, or folded over: cosine of 84°.
  double min_facing_cos = 0.1;
  /// Twice the area over the squared longest edge; below it a triangle is a needle without a normal.
  double min_shape = 0.01;
};

/// Which triangles a cell of four samples carries. Corners: (r, c) = 00, (r, c+1) = 01, (r+1, c) = 10,
/// (r+1, c+1) = 11. Without kCellAntidiagonal the first triangle is 00-10-11 and the second 00-11-01; with it
/// they are 00-10-01 and 10-11-01.
enum CellBit : std::uint8_t { kCellAntidiagonal = 1, kCellFirst = 2, kCellSecond = 4 };

/// The samples of a grid as positions and normals in one frame, whichever that is, with the view in the same
/// frame. Arrays are row major, rows × cols.
struct GridSurface {
  int rows = 0;
  int cols = 0;
  double spacing_mm = 0;
  std::span<const Eigen::Vector3f> points;
  std::span<const Eigen::Vector3f> normals;  ///< zero where undefined
  ScannerView view;

  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

/// The three samples of a cell's first (0) or second (1) triangle, in the order that suits a grid whose rows
/// and columns are not mirrored.
[[nodiscard]] inline std::array<std::size_t, 3> cell_triangle(const GridSurface& surface, int row, int col,
                                                              std::uint8_t cell, int which) {
  const std::size_t i00 = surface.index(row, col);
  const std::size_t i01 = i00 + 1;
  const std::size_t i10 = i00 + static_cast<std::size_t>(surface.cols);
  const std::size_t i11 = i10 + 1;
  if ((cell & kCellAntidiagonal) != 0) {
    return which == 0 ? std::array{i00, i10, i01} : std::array{i10, i11, i01};
  }
  return which == 0 ? std::array{i00, i10, i11} : std::array{i00, i11, i01};
}

/// 1 for the samples that a triangle of CellBit codes [rows*cols] has as a corner.
[[nodiscard]] std::vector<std::uint8_t> corners_of_cells(std::span<const std::uint8_t> cells, int rows,
                                                         int cols);

/// True when rows × columns run so that the triangles of cell_triangle() have to be turned over to face the
/// scanner: one answer for the grid, so that its faces agree with each other. Decided by the majority of
/// triangles among the kept samples.
[[nodiscard]] bool is_mirrored(const GridSurface& surface, std::span<const std::uint8_t> keep);

/// CellBit codes [rows*cols] of the triangles between samples with keep != 0 (the last row and column hold
/// 0). The diagonal is the one along which the gradient changes less, so that a ridge or valley that runs
/// along it is kept (seed 001, 4, figure 8); three good corners give one triangle. Linear in the samples, in
/// parallel over rows.
[[nodiscard]] std::vector<std::uint8_t> triangulate_cells(const GridSurface& surface,
                                                          std::span<const std::uint8_t> keep, bool mirrored,
                                                          const GridTriangulationOptions& options);

/// The same again for the cells with only[cell] != 0; the others stay as they are.
void triangulate_cells_anew(const GridSurface& surface, std::span<const std::uint8_t> keep, bool mirrored,
                            const GridTriangulationOptions& options, std::span<const std::uint8_t> only,
                            std::span<std::uint8_t> cells);

/// One grid's own mesh in the scanner frame: non-sparse samples (is_unflagged) joined on the grid's plane and
/// oriented towards the scanner, with the normals of its samples (grid_geometry). `flags` may be empty: then
/// every valid sample takes part. A grid without a triangle, or without a spacing, gives an empty mesh.
[[nodiscard]] Mesh triangulate_grid(const RangeGrid& grid, const SampleFlags& flags,
                                    const GridTriangulationOptions& options = {});

}  // namespace dubsar
