// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <string>

#include "registration/model_fit.h"

namespace dubsar {

/// That one part of a scan's rows lies to the rest as it never did on the tablet.
struct ScanMotion {
  double row = 0;       ///< where the largest part of it happened, as a share of the scan's rows
  double shift_mm = 0;  ///< of the one part against the other
  int gained = 0;  ///< samples that agree with the other scans where their own part puts them, and not here
};

/// Looks whether the tablet or the scanner moved while the scan was taken: a few bands of its rows are fitted
/// to the other scans, each on its own, from where the scan lies. Where a band agrees in another place as
/// well as scans in their right places do, and not where the scan lies, and not all bands ask for the same
/// move, something moved. `fit` is that of the whole scan in `model` (judge_in_model). What neither shape nor
/// relief of a band holds cannot be told. `was_found`: it was the last time; then less is enough, or poses
/// that change by micrometres would turn the verdict to and fro.
[[nodiscard]] std::optional<ScanMotion> find_motion(const ScanSurface& scan, std::span<const ModelScan> model,
                                                    const ModelFit& fit, const ModelFitOptions& options,
                                                    bool was_found = false);

/// What costs less says so beforehand, for tests: false where find_motion() has nothing that it would fit
/// whole.
[[nodiscard]] bool may_have_moved(const ScanSurface& scan, std::span<const ModelScan> model,
                                  const ModelFit& fit, const ModelFitOptions& options);

/// For people: what happened, and the mend.
[[nodiscard]] std::string reason_of(const ScanMotion& motion);

}  // namespace dubsar
