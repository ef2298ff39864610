// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_mask.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// True where the sample lies on the arm, or on what would be more of it farther out.
bool in_envelope(const PinArm& arm, const Eigen::Vector3d& p, double margin_mm, double radius_mm,
                 bool alone) {
  const double s = arm.cone.along(p);
  // Without its tip, which way an arm goes on is not known: the tablet may be there.
  const bool before_tip = arm.ball && s < arm.cone.along(arm.ball->center_mm) - radius_mm - margin_mm;
  const bool off_end =
      !arm.ball && !alone && (s < arm.cone.low_mm - margin_mm || s > arm.cone.high_mm + margin_mm);
  if (before_tip || off_end) {
    return false;
  }
  return arm.cone.from_axis(p) <= std::max(radius_mm, arm.cone.radius_at(s)) + margin_mm;
}

}  // namespace

void mask_remnants(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& clay,
                   const std::vector<std::optional<PinArm>>& found, double far_mm, double spacing_mm,
                   std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> other(sheets.components.size(), 1);
  for (std::size_t c = 0; c < other.size(); ++c) {
    other[c] = found[c] ? 0 : 1;
  }
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (clay[c] != 0 || found[c]) {
          return;
        }
        const GridPiece piece = piece_of(grid, sheets, c);
        if (at_border(grid, piece.samples) >= 2 ||
            standing_clear(grid, sheets, other, piece, far_mm, spacing_mm) >= 1.0) {
          for (const std::uint32_t i : piece.samples) {
            mask[i] = 1;
          }
        }
      },
      4);
}

void fill_mask(const RangeGrid& grid, const Sheets& sheets, const std::vector<std::uint8_t>& large,
               const std::vector<std::uint8_t>& clay, const std::vector<PinArm>& arms, const PinScale& scale,
               std::vector<std::uint8_t>& mask) {
  const double margin_mm = std::max(1.5 * scale.spacing_mm, 6.0 * scale.noise_mm);
  const auto in_any = [&](std::size_t i, bool alone) {
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    return std::any_of(arms.begin(), arms.end(),
                       [&](const PinArm& b) { return in_envelope(b, p, margin_mm, scale.radius_mm, alone); });
  };
  for (const PinArm& arm : arms) {
    for (const std::uint32_t i : arm.samples) {
      mask[i] = 1;
    }
  }
  // Pieces of arms that were too small or too hidden to be known by themselves.
  parallel_for_each_index(
      sheets.components.size(),
      [&](std::size_t c) {
        if (large[c] != 0) {
          return;
        }
        const std::vector<std::uint32_t> samples = samples_of(sheets, grid, c);
        if (samples.empty() || mask[samples.front()] != 0) {
          return;
        }
        const auto inside = static_cast<std::size_t>(std::count_if(
            samples.begin(), samples.end(), [&](std::uint32_t i) { return in_any(i, clay[c] == 0); }));
        if (10 * inside >= 7 * samples.size()) {
          for (const std::uint32_t i : samples) {
            mask[i] = 1;
          }
        }
      },
      4);
  const std::vector<std::uint8_t> known = mask;
  const auto step2 = static_cast<float>(std::pow(4.0 * scale.spacing_mm, 2));
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t row) {
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = grid.index(static_cast<int>(row), col);
          if (grid.valid[i] == 0 || sheets.label[i] >= 0 || !grid.point(i).allFinite()) {
            continue;
          }
          if (in_any(i, false)) {
            mask[i] = 1;
            continue;
          }
          float to_pin2 = step2;
          float to_other2 = step2;
          for (int dr = -1; dr <= 1; ++dr) {
            for (int dc = -1; dc <= 1; ++dc) {
              const int r = static_cast<int>(row) + dr;
              const int c = col + dc;
              if (!grid.is_valid(r, c) || sheets.label[grid.index(r, c)] < 0) {
                continue;
              }
              const std::size_t j = grid.index(r, c);
              float& nearest = known[j] != 0 ? to_pin2 : to_other2;
              nearest = std::min(nearest, (grid.point(j) - grid.point(i)).squaredNorm());
            }
          }
          mask[i] = to_pin2 < to_other2 ? 1 : 0;
        }
      },
      16);
}

}  // namespace dubsar
