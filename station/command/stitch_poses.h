// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "station/command/scan_set_options.h"

namespace dubsar {

/// The poses of --poses, of which each is given to one scan.
class GivenPoses {
 public:
  /// Errors: those of read_poses_file() and of reading the scans.
  [[nodiscard]] static Result<GivenPoses> read(const ScanSetArguments& arguments, JobContext& job);

  /// The scan's, or none. Where the other scans have to be known for that, they are read once more for their
  /// names. Errors: those of reading them.
  [[nodiscard]] Result<const ScanPose*> of(const StationScan& scan, JobContext& job);
  /// Why it has none.
  [[nodiscard]] std::string lacks(const StationScan& scan) const;
  /// Whether the file says how far the pose, one of its own, may be off.
  [[nodiscard]] bool says_sigma(const ScanPose& pose) const;
  /// Those that were not given.
  [[nodiscard]] std::vector<ScanPose> rest() const;

 private:
  explicit GivenPoses(const ScanSetArguments& arguments) : arguments_(&arguments) {}
  Status read_names(JobContext& job);

  const ScanSetArguments* arguments_;
  std::vector<ScanPose> poses_;
  std::vector<bool> says_sigma_;  ///< of each
  std::optional<std::vector<StationScan>> names_;
  std::set<const ScanPose*> given_;
};

}  // namespace dubsar
