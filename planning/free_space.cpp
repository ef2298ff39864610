// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/free_space.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/sample_flags.h"
#include "planning/clearing.h"

namespace dubsar {

namespace {

/// Of the cell: how far apart lines of sight and places on them are, so that none in between is missed.
constexpr double kStepOfCell = 0.5;
/// Cells from a sample on: what is looked at lies in the first itself.
constexpr double kClearOfSample = 2.0;

}  // namespace

FreeSpace::FreeSpace(std::span<const PlacedScan> scans, const Eigen::AlignedBox3d& box_mm, double cell_mm)
    : box_mm_(box_mm), cell_mm_(cell_mm) {
  constexpr double kMostPerAxis = 160.0;
  if (box_mm_.isEmpty()) {
    return;
  }
  cell_mm_ = std::max({cell_mm, box_mm_.sizes().maxCoeff() / kMostPerAxis, 1e-6});
  std::size_t cells = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    count_[k] = static_cast<std::size_t>(box_mm_.sizes()[static_cast<int>(k)] / cell_mm_) + 1;
    cells *= count_[k];
  }
  free_.assign(cells, 0);
  for (const PlacedScan& scan : scans) {
    look_from(scan);
  }
}

std::size_t FreeSpace::cell_of(const Eigen::Vector3d& p_mm) const {
  if (free_.empty() || !box_mm_.contains(p_mm)) {
    return kNowhere;
  }
  std::size_t cell = 0;
  for (std::size_t k = 3; k-- > 0;) {
    const int axis = static_cast<int>(k);
    const auto at = static_cast<std::size_t>((p_mm[axis] - box_mm_.min()[axis]) / cell_mm_);
    cell = cell * count_[k] + std::min(at, count_[k] - 1);
  }
  return cell;
}

bool FreeSpace::was_looked_through(const Eigen::Vector3d& p_mm) const {
  const std::size_t cell = cell_of(p_mm);
  return cell != kNowhere && free_[cell] != 0;
}

void FreeSpace::look_from(const PlacedScan& scan) {
  const RangeGrid& grid = *scan.grid;
  const double step_mm = kStepOfCell * cell_mm_;
  const int stride = std::max(1, static_cast<int>(step_mm / std::max(spacing_of(grid), 1e-6)));
  parallel_for_each_index(
      static_cast<std::size_t>((grid.rows + stride - 1) / stride),
      [&](std::size_t line) {
        const int row = static_cast<int>(line) * stride;
        for (int col = 0; col < grid.cols; col += stride) {
          const std::size_t i = grid.index(row, col);
          if (grid.valid[i] == 0 || !is_unflagged((*scan.flags)[i]) || !grid.point(i).allFinite()) {
            continue;
          }
          const Eigen::Vector3d seen = grid.point(i).cast<double>();
          const Eigen::Vector3d p = scan.model_from_scanner * seen;
          const Eigen::Vector3d step =
              step_mm * (scan.model_from_scanner.rotation * grid.view.to_camera(seen, row));
          // The box is convex: who has left it does not come back.
          for (double k = kClearOfSample / kStepOfCell;; k += 1) {
            const std::size_t cell = cell_of(p + k * step);
            if (cell == kNowhere) {
              break;
            }
            std::atomic_ref(free_[cell]).store(1, std::memory_order_relaxed);
          }
        }
      },
      4);
}

}  // namespace dubsar
