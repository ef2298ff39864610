// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/pin_set.h"
#include "core/range_grid.h"

namespace dubsar {

struct PinDetectionOptions {
  double step_factor = 4.0;       ///< neighbours farther apart than this many µ are on two things
  double most_width = 2.0;        ///< of the tip's diameter: anything wider inside is no pin
  double most_share = 0.2;        ///< of all samples: a component larger than this is the tablet
  double ball_tolerance = 0.12;   ///< of the tip's radius: residual of a sample on the ball
  double least_ball_share = 0.5;  ///< of the samples that half a visible ball would show at this spacing
  double most_ball_rms = 0.1;     ///< of the tip's radius
};

/// What was found of the pins in one scan.
struct PinDetection {
  std::vector<PinTip> tips;        ///< unlabelled ball centres, scanner frame, in row order
  std::vector<double> rms_mm;      ///< [tips], of the sphere fit
  std::vector<std::uint8_t> mask;  ///< [rows*cols], 1 on pins and arms
};

/// Finds pins (thin cones with spherical tips of known diameter on arms, seed 001, 3.2): they stand clear of
/// the clay, so depth steps part them from it; a component of the grid that is thin everywhere is a pin or an
/// arm, and where a sphere of the right size fits its samples, that is its tip. A tip that touches the clay
/// is not found.
[[nodiscard]] PinDetection detect_pins(const RangeGrid& grid, double tip_diameter_mm,
                                       const PinDetectionOptions& options);

/// [rows*cols], 1 on samples of pins and arms: SampleFlag kNotTablet.
[[nodiscard]] std::vector<std::uint8_t> pin_mask(const RangeGrid& grid, double tip_diameter_mm,
                                                 const PinDetectionOptions& options = {});

/// The operator's tips, each moved onto the nearest detected one within the diameter and a millimetre (clicks
/// are good to 1 mm); detected tips that nobody labelled follow unlabelled.
[[nodiscard]] std::vector<PinTip> labelled_tips(const std::vector<PinTip>& detected,
                                                const std::vector<PinTip>& clicked, double tip_diameter_mm);

}  // namespace dubsar
