// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/seen_pin.h"

namespace dubsar {

struct PinMatchOptions {
  double replaced_sigma_mm = 0.3;  ///< of a tip per axis, each time pins are put back
  double distance_sigmas = 3.0;    ///< mutual distances that differ by more are not the same two pins
  double outlier_sigmas = 3.4;     ///< of a tip's residual; beyond, it was put back wrong or is another pin
  double label_is_right = 0.7;     ///< chance that both scans name a pin rightly, at the worst
  int least_labelled = 3;          ///< matched pins of a candidate when as many labels agree
  /// And without. Three distances coincide by chance (see PinMatch::chance), but seldom often: where a scan
  /// shows no more, the surface has few candidates to choose from.
  int least_unlabelled = 3;
  std::size_t most_candidates = 5;
  double least_score_below_best =
      15;                          ///< candidates whose log likelihood is lower by more are not worth a try
  double distinct_turn_rad = 0.1;  ///< poses that differ by less, in turn …
  double distinct_shift_mm = 2.0;  ///< … and at the middle of the tips, are one
};

/// One way in which the pins of two scans may correspond.
struct PinMatch {
  RigidTransform target_from_source;
  std::vector<std::pair<int, int>> pairs;  ///< indices into source and target, by source
  int labels_agree = 0;                    ///< pairs in which both carry the same label
  double rms_mm = 0;                       ///< distance between the tips of a pair
  /// Log likelihood ratio of the pairs against tips that fall where they do by chance, labels included.
  double score = 0;
  /// Expected number of matchings of two unrelated sets of tips, of these numbers, that agree as well (labels
  /// left out). Far below 1: not chance, but a symmetric layout still has several such matchings.
  double chance = 0;
};

/// Matches the tips of two scans by mutual distances and, where they carry any, by labels, of which some may
/// be wrong; solves each candidate by Horn, weighted by the tips' covariances and what putting pins back
/// adds, without the pairs that do not fit. Best score first; distinct poses; empty when too few tips agree
/// or those that do lie on a line. A first pose for the surface to decide on, never the last.
[[nodiscard]] std::vector<PinMatch> match_pins(const std::vector<SeenPin>& source,
                                               const std::vector<SeenPin>& target,
                                               const PinMatchOptions& options);

}  // namespace dubsar
