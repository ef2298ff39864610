// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/range_grid.h"
#include "registration/pin_body.h"
#include "registration/pin_components.h"
#include "registration/pin_detection.h"
#include "registration/pin_noise.h"
#include "registration/pin_piece.h"

namespace dubsar {

/// What one scan's pins are measured by.
struct PinScale {
  double radius_mm = 0;                  ///< of a tip
  double spacing_mm = 0;                 ///< µ
  double noise_mm = 0;                   ///< along the ray
  double disc = 0;                       ///< samples of a ball's whole disc
  double on_arm_mm = 0, on_ball_mm = 0;  ///< residuals of inliers
};

/// A component that is an arm, with its tip where it shows it.
struct PinArm {
  Cone cone;  ///< its axis runs from the tip outwards
  std::optional<Ball> ball;
  std::vector<std::uint32_t> samples;
  RowNoiseSums noise;
  bool settled = true;  ///< else only its place among the others can tell that it is no clay
};

/// The arm that a piece is; nothing where it is none. `large`: components too wide for one; `alone`: nothing
/// connects the piece with clay.
[[nodiscard]] std::optional<PinArm> find_pin_arm(const RangeGrid& grid, const Sheets& sheets,
                                                 const std::vector<std::uint8_t>& large, bool alone,
                                                 GridPiece piece, const PinScale& scale,
                                                 const PinDetectionOptions& options);

}  // namespace dubsar
