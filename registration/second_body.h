// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/job.h"
#include "registration/global_align.h"
#include "registration/pose_search.h"

namespace dubsar {

/// A part of a scan that was moved against the rest of what is in view since the other scans.
struct SecondBody {
  double turn_rad = 0;
  double shift_mm = 0;  ///< of its middle
};

/// Looks whether what a scan shows are two things that moved against each other between the scans: a tablet
/// and the textured support that it lies on, or two fragments. Whichever is larger sets the pose, and the
/// tablet may be the other one. Where a connected part of the scan does not agree with the others at `fit`,
/// that part is searched in each of them by itself, as if it were a scan; it is a second body when its relief
/// leaves no doubt that it lies elsewhere. `others` are the features of the scans in `model`, in its order.
[[nodiscard]] std::optional<SecondBody> find_second_body(
    const ScanSurface& scan, std::span<const ScanFeatures* const> others, std::span<const ModelScan> model,
    const ModelFit& fit, const ScanSurfaceOptions& surface, const PoseSearchOptions& options,
    const JobContext& job);

/// For people: what happened, and the mend.
[[nodiscard]] std::string reason_of(const SecondBody& body);

}  // namespace dubsar
