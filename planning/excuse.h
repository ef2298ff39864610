// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "core/placed_scan.h"
#include "planning/next_view.h"
#include "planning/red_targets.h"
#include "planning/surface_cover.h"

namespace dubsar {

struct ExcuseOptions {
  double interpolation_mm = 0.025;     ///< seed 001: 25 µm
  double largest_gap_mm = 0.6;         ///< below half the smallest wedge: larger holes may hide a sign
  double fit_margin_mm = 0.45;         ///< of surface around the hole that the fit uses; at least 4.5 µ
  double confidence_sigmas = 2.0;      ///< the interpolation error is stated at this many standard errors
  double stray_mm = 0.2;               ///< farther than this from the surface a return is not of the surface
  int stray_views = 1;                 ///< other scans that look past it
  std::size_t most_stray_samples = 3;  ///< a larger group is taken for a stray only when it is looked past
  /// Below this best predicted chance over all poses a place is out of reach.
  double least_chance = 0.05;
  /// Red that covers less than this many µ² is a speck: of the size that noise makes; `speck_tries` settle
  /// it.
  double speck_spacings2 = 10.0;
  /// Of the surface: all that is still red when the last specks go, and all slits and pits together.
  double speck_budget = 2e-4;
  int speck_tries = 2;
  double tried_speck_budget = 1e-3;  ///< of the surface, for all that are settled by looks together
  double largest_slit_mm2 = 0.5;     ///< half the footprint of the smallest wedge, 1 mm across
  int tries = 4;  ///< scans, from so many places, that ought to have seen a place before it is given up
};

/// Unneeded: holes no wider than largest_gap_mm over which the surface is interpolated well enough. The test:
/// a quadric is fitted to the well-sampled surface of all scans around the hole, on all six sides of it. What
/// its residuals exceed the scans' noise by is how far the surface bends away from a quadric; together with
/// confidence_sigmas standard errors of the fit inside the hole it must stay below interpolation_mm, and no
/// red sample may deviate by more than that and three times the noise. noise_mm: of a sample.
void excuse_unneeded(std::span<const PlacedScan> scans, const SurfaceCover& cover, double noise_mm,
                     const ExcuseOptions& options, RedTargets& red);

/// Unneeded: specks, groups of red (as red_regions() groups them, but no wider gaps across) that cover no
/// more than speck_spacings2 µ², are no wider than largest_gap_mm, and border neither a hole of the cover
/// that is larger nor a patch that nobody has seen: those that speck_tries scans, each from elsewhere, looked
/// at and found nothing more, the smallest first, as long as they are together below tried_speck_budget; and
/// the last ones, when all that is still red is, together, below speck_budget of the tablet's surface, where
/// a straight line closes them: the rule of 3µ lets gaps of that size pass anywhere. surface_mm2: of the
/// tablet. The targets' tries must be known (note_tries()).
void excuse_specks(std::span<const PlacedScan> scans, const SurfaceCover& cover, double surface_mm2,
                   const ExcuseOptions& options, RedTargets& red);

/// Unneeded: what is left when all of it together is below speck_budget of the surface, no view is expected
/// to clear as much as a single speck, and what hangs together is no larger than largest_slit_mm2. What gives
/// no signal does not count, and stays red with all that hangs together with it.
void excuse_last_specks(std::span<const PlacedScan> scans, const SurfaceCover& cover, double best_gain_mm2,
                        double surface_mm2, const ExcuseOptions& options, RedTargets& red);

/// Unneeded: strays, returns from nowhere (outliers, mixed pixels at depth edges). The test: no surface of
/// the model lies within stray_mm (at least 2 µ) of the red samples, and at least stray_views scans sample
/// the surface behind them well, through the very place. noise_mm: by scan.
void excuse_strays(std::span<const PlacedScan> scans, std::span<const double> noise_mm,
                   const ModelSurface& surface, const ExcuseOptions& options, RedTargets& red);

/// What nothing will clear and hangs together over more than largest_slit_mm2 is unreachable where by the
/// model no pose has a good look at it. Where one has, it stays red and is named (RedTarget::no_signal): ink,
/// gloss or a deep hole, which a person tells apart. Smaller places are unneeded as long as all of them
/// together, by whichever of these rules, stay below speck_budget (RedTargets::slits_mm2): most could be seen
/// into from some pose, but hide no sign.

/// By pose limits: no pose that the rig allows is expected to sample the place. best_chance as in NextViews,
/// over all candidates; entries below 0 were not judged and stay red.
void excuse_out_of_reach(std::span<const PlacedScan> scans, const SurfaceCover& cover,
                         std::span<const float> best_chance, double surface_mm2, const ExcuseOptions& options,
                         RedTargets& red);

/// By trial: at least `tries` scans, no two of them from one place (full_looks_apart()), ought to have seen
/// the place by all that is known, and none brought dense samples. What of it stays red is given up after
/// twice as many. Applies to rig and replay alike.
void excuse_tried(std::span<const PlacedScan> scans, const SurfaceCover& cover, double surface_mm2,
                  const ExcuseOptions& options, RedTargets& red);

/// By trial, too: at least `tries` scans, from wherever, might have seen the place, with the chance of a full
/// look together (looks_worth()), and after these looks in vain no candidate is expected to sample it any
/// more. Unreachable where none had a good look at it either. Of `views`, best_left and best_chance count;
/// entries below 0 were not judged and stay red.
void excuse_tried_out(std::span<const PlacedScan> scans, const SurfaceCover& cover, const NextViews& views,
                      double surface_mm2, const ExcuseOptions& options, RedTargets& red);

}  // namespace dubsar
