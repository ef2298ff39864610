// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "station/results.h"
#include "station/scan_set.h"

namespace dubsar {

/// The verdict, worked out anew from grids and poses alone.
struct PlannedAgain {
  std::unique_ptr<PlanningStage> stage;  ///< refers to the scans of the set
  Results results;
};

/// Red map, mesh and checklist of the set's scans under these poses, by the same stages as the engine. Poses
/// of scans that are not in the set (taken out, damaged) are left aside. The verdict never rests on the mesh;
/// where the session holds the mesh of these very poses it is taken, since stitching takes longer than all
/// the rest. Errors: kCancelled, the stages'.
[[nodiscard]] Result<PlannedAgain> plan_again(const ScanSet& set, const std::vector<ScanPose>& poses,
                                              JobContext& job);

/// What is red and what is excused on a mesh of the same scans under these poses, as the engine showed it: of
/// the verdict nothing else is worked out. Errors: kCancelled, the stages'.
[[nodiscard]] Result<ColouredPoints> red_points_again(const ScanSet& set, const std::vector<ScanPose>& poses,
                                                      const Mesh& mesh, JobContext& job);

/// Where a red map that was worked out anew is not the stored one, in words; empty when both are the same to
/// the last digit. Nothing when none is stored. kBadInput when the stored one cannot be read.
[[nodiscard]] Result<std::optional<std::vector<std::string>>> differs_from_stored(const SessionStore& store,
                                                                                  const RedMap& anew);

}  // namespace dubsar
