// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_piece.h"

#include <algorithm>
#include <cmath>

namespace dubsar {

namespace {

/// Samples of a piece whose surroundings are looked at.
constexpr std::size_t kClearSamples = 96;

}  // namespace

GridPiece piece_of(const RangeGrid& grid, const Sheets& sheets, std::size_t component) {
  GridPiece piece;
  piece.samples = samples_of(sheets, grid, component);
  piece.points_mm.reserve(piece.samples.size());
  for (const std::uint32_t i : piece.samples) {
    piece.points_mm.push_back(grid.point(i).cast<double>());
  }
  const std::uint32_t middle = piece.samples[piece.samples.size() / 2];
  piece.to_camera = grid.view.to_camera(grid.point(middle).cast<double>(), grid.row_of(middle));
  return piece;
}

int at_border(const RangeGrid& grid, const std::vector<std::uint32_t>& samples) {
  return static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](std::uint32_t i) {
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    return row == 0 || col == 0 || row + 1 == grid.rows || col + 1 == grid.cols;
  }));
}

double standing_clear(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& large,
                      const GridPiece& piece, double clear_mm, double spacing_mm) {
  const int reach = static_cast<int>(std::ceil(clear_mm / spacing_mm));
  const int hop = std::max(1, reach / 8);
  const auto clear2 = static_cast<float>(clear_mm * clear_mm);
  const std::size_t stride = std::max<std::size_t>(1, piece.samples.size() / kClearSamples);
  const std::int32_t own = sheets.label[piece.samples.front()];
  std::size_t looked = 0;
  std::size_t clear = 0;
  for (std::size_t k = stride / 2; k < piece.samples.size(); k += stride) {
    const std::uint32_t i = piece.samples[k];
    bool near = false;
    for (int dr = -reach; dr <= reach && !near; dr += hop) {
      for (int dc = -reach; dc <= reach && !near; dc += hop) {
        const int row = grid.row_of(i) + dr;
        const int col = grid.col_of(i) + dc;
        if (!grid.inside(row, col)) {
          continue;
        }
        const std::size_t j = grid.index(row, col);
        near = sheets.label[j] >= 0 && sheets.label[j] != own &&
               large[static_cast<std::size_t>(sheets.label[j])] != 0 &&
               (grid.point(j) - grid.point(i)).squaredNorm() < clear2;
      }
    }
    ++looked;
    clear += near ? 0U : 1U;
  }
  return looked > 0 ? static_cast<double>(clear) / static_cast<double>(looked) : 0.0;
}

}  // namespace dubsar
