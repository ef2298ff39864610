// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>
#include <vector>

#include "core/job.h"
#include "core/red_map.h"
#include "core/result.h"
#include "planning/red_targets.h"
#include "planning/view_candidates.h"

namespace dubsar {

struct NextViewOptions {
  CandidateOptions candidates;
  std::size_t max_targets = 1500;  ///< more are thinned, their areas shared out
  /// Of targets that were thinned out it is only worked out whether some candidate has so much chance.
  double enough_chance = 0.05;
  double least_overlap = 0.3;    ///< with what has been seen, to register
  double hand_turn_cost = 0.25;  ///< of lifting the tablet, in scans
  double lean_cost = 1.0;        ///< of propping it as well
  double least_gain_mm2 = 1e-4;  ///< a view that clears less is not proposed
  std::size_t ranked = 5;        ///< views returned
};

/// What to do next, and what all candidates together promise: best_chance is the greatest over all of them.
struct NextViews {
  std::vector<NextView> ranked;  ///< best first
  /// Greatest red area that any candidate is expected to clear, whether it is proposed or not: what is
  /// excused rests on it, so scans that perhaps looked at a place (RedTarget::perhaps) take nothing from it.
  double best_gain_mm2 = 0;
  std::vector<float> best_chance;  ///< [targets]; -1 for targets that are not red, or given up
  std::vector<float> best_left;    ///< the same, looks in vain considered
};

/// Notes for each red target which of the scans ought to have seen it (red_targets() leaves that empty).
/// What lay outside the field of a scan was not looked at by it. noise_mm: by scan; rig: that took them, or
/// null.
void note_tries(std::span<const PlacedScan> scans, const Rig* rig, std::span<const double> noise_mm,
                const ModelSurface& surface, std::vector<RedTarget>& targets);

/// For each target the chance that the view clears it, looks in vain considered; 0 for those that are not
/// red.
[[nodiscard]] std::vector<double> clearing_chances(const ViewCandidate& candidate,
                                                   const ScannerModel& scanner, const ModelSurface& surface,
                                                   std::span<const RedTarget> targets);

/// The next best views: the area of red that each candidate is expected to clear, tested against incidence,
/// field, support, and occlusion of laser and camera by the model so far, per scan of time. A target that was
/// looked at in vain counts less, least from the same side. Candidates that overlap too little with what was
/// seen are left out, unless none overlaps enough. Errors: kCancelled.
[[nodiscard]] Result<NextViews> next_views(std::span<const ViewCandidate> candidates,
                                           const ScannerModel& scanner, const ModelSurface& surface,
                                           std::span<const RedTarget> targets, const NextViewOptions& options,
                                           JobContext& job);

}  // namespace dubsar
