// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "planning/red_targets.h"

namespace dubsar {

struct ExcuseOptions {
  double interpolation_mm = 0.025;  ///< seed 001: 25 µm
  double largest_gap_mm = 0.6;      ///< below half the smallest wedge: larger holes may hide a sign
  int fit_margin = 4;               ///< good samples around the hole that the fit uses, in cells
  double confidence_sigmas = 2.0;   ///< the interpolation error is stated at this many standard errors
  double stray_mm = 0.2;            ///< farther than this from the surface a return is not of the surface
  int stray_views = 1;              ///< other scans that look past it
  /// Below this best predicted chance over all poses a place is out of reach.
  double least_chance = 0.05;
  /// Red that covers less than this many µ² is a speck: of the size that noise makes; `speck_tries` settle
  /// it.
  double speck_spacings2 = 10.0;
  int speck_tries = 2;
  int tries = 3;  ///< scans that ought to have seen a place before it is given up
};

/// Unneeded: holes no wider than largest_gap_mm over which the surface is interpolated well enough. The test:
/// a quadric is fitted to the non-flagged samples of one scan around the hole, on all six sides of it; the
/// standard deviation of its residuals is below interpolation_mm, its standard error at every red sample
/// times confidence_sigmas is below interpolation_mm, and no red sample deviates from it by more than that
/// plus three standard deviations. A clear outcome in one scan is enough.
void excuse_unneeded(std::span<const PlacedScan> scans, const ExcuseOptions& options, RedTargets& red);

/// Unneeded: strays, returns from nowhere (outliers, mixed pixels at depth edges). The test: no surface of
/// the model lies within stray_mm (at least 2 µ) of the red samples, and at least stray_views scans sample
/// the surface behind them well, through the very place; or the place
/// lies inside the clay, surface around it on all sides. noise_mm: by scan.
void excuse_strays(std::span<const PlacedScan> scans, std::span<const double> noise_mm,
                   const ModelSurface& surface, const ExcuseOptions& options, RedTargets& red);

/// Unreachable by pose limits: no pose that the rig allows is expected to sample the place. best_chance as in
/// NextViews, over all candidates; entries below 0 were not judged and stay red.
void excuse_out_of_reach(std::span<const float> best_chance, const ExcuseOptions& options, RedTargets& red);

/// Unreachable by trial: at least `tries` scans (`speck_tries` for a speck) ought to have seen the place by
/// all that is known, and none brought dense samples. Applies to rig and replay alike.
void excuse_tried(double spacing_mm, const ExcuseOptions& options, RedTargets& red);

}  // namespace dubsar
