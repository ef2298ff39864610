// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/range_grid.h"
#include "registration/seen_pin.h"

namespace dubsar {

// Lengths are parts of the tip's diameter or radius, or in µ, where they are not in millimetres.
struct PinDetectionOptions {
  double step_factor = 4.0;         ///< neighbours farther apart than this many µ are on two things
  double most_width = 3.2;          ///< of the tip's diameter: anything wider is no arm
  double least_arm_radius = 0.5;    ///< of the tip's radius
  double full_coverage_rad = 2.0;   ///< angle about its axis that an arm shows; seen side on it is almost π
  double least_coverage_rad = 1.0;  ///< the same for a long arm that is hidden in part
  double least_part_discs = 2.0;    ///< samples of such an arm, in parts of those of a ball's whole disc
  double least_length = 1.5;        ///< of an arm, of its mean width
  double least_arm_share = 0.88;    ///< of a component's samples that lie on its arm
  double most_arm_noise = 1.6;      ///< residuals of an arm, of the noise
  double most_clear_mm = 0.8;       ///< from clay (less for small tips) …
  double least_clear_share = 0.9;   ///< … is where at least this share of an arm's samples stands
  double alone_mm = 1.0;            ///< farther than this from anything that hangs together with clay
  double near_mm = 1.5;             ///< around a piece that is an arm by its place only, nothing but arms
  double far_mm = 3.0;              ///< from everything but arms, no piece of the grid is clay
  double least_disc_share = 0.08;   ///< of the samples of a ball's whole disc, for a tip
  double most_ball_rms = 0.1;       ///< of the tip's radius, beside three times the noise
  double most_sigma_mm = 0.25;      ///< a tip that is known worse than it is put back does not help
};

/// What was found of the pins in one scan.
struct PinDetection {
  std::vector<SeenPin> tips;       ///< unlabelled, in the order of their components in the grid
  std::vector<double> rms_mm;      ///< [tips], of the sphere fit
  std::vector<std::uint8_t> mask;  ///< [rows*cols], 1 on pins and arms
  double noise_mm = 0;             ///< of a sample across the surface of the arms; 0 when none is seen
};

/// Finds pins (balls of known diameter on arms that are cones or cylinders; seed 001, 3.2). They stand clear
/// of the clay, so that depth steps part them from it: a part of the grid that is thin everywhere and lies on
/// a cone of a plausible radius is an arm. Its tip is at the end that the field does not cut off, where the
/// half of a ball of the right size fits and what would be more arm does not. The fit's covariance takes in
/// the samples' geometry and the noise with its correlation along the profile, both as the arms show them.
[[nodiscard]] PinDetection detect_pins(const RangeGrid& grid, double tip_diameter_mm,
                                       const PinDetectionOptions& options);

/// [rows*cols], 1 on samples of pins and arms: SampleFlag kNotTablet.
[[nodiscard]] std::vector<std::uint8_t> pin_mask(const RangeGrid& grid, double tip_diameter_mm,
                                                 const PinDetectionOptions& options = {});

}  // namespace dubsar
