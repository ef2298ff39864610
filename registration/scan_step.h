// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <string>

#include "registration/model_fit.h"

namespace dubsar {

/// How the rows after one of a scan lie to those before it, other than they lay on the tablet: a move too
/// small for find_motion(), which asks that a part of the scan agree in another place and not in its own.
struct ScanStep {
  double row = 0;       ///< where it happened, as a share of the scan's rows
  double shift_mm = 0;  ///< of the scan's middle
  double turn_rad = 0;
  double moved_mm = 0;  ///< root mean square over the scan
  double chi2 = 0;      ///< of its six numbers over their covariance
  double of_drift = 0;  ///< what it explains, over what a steady drift of all six numbers would
  double common = 0;    ///< over what a step of its own for each other scan would

  /// Beyond what right scans were seen to show, and better explained by a step than otherwise.
  [[nodiscard]] bool is_told(double spacing_mm) const;
};

/// Fits the two parts of the scan before and after each of some rows to the other scans, each part on its
/// own. Both parts are compared on each other scan by itself, so that how those lie to each other does not
/// show. `fit` is that of the whole scan in `model` (judge_in_model). Nothing where one sample in some shows
/// none, or where too little is shared.
[[nodiscard]] std::optional<ScanStep> find_step(const ScanSurface& scan, std::span<const ModelScan> model,
                                                const ModelFit& fit);

/// For people: what happened, and the mend.
[[nodiscard]] std::string reason_of(const ScanStep& step);

}  // namespace dubsar
