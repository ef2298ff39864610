// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/placed_scan.h"
#include "core/result.h"
#include "core/scan_pose.h"
#include "station/scan_set.h"

namespace dubsar {

struct RegisterOptions {
  bool use_pins = true;
  std::optional<int> rounds;  ///< of pairwise fits and relaxation at the end; the registrar's default
  std::vector<int> only;      ///< ids to register anew; empty: all
  /// Poses to start from, of scans of the set: these are refined and verified, and nothing else is looked
  /// for. A scan without one is failed. With `only`, the other scans stay where these poses (or, without
  /// them, those of the set) have them; with neither, the others take no part.
  std::optional<std::vector<ScanPose>> from_poses;
};

/// Registers the scans of the set, in order, with a final relaxation, as the operator's hints and locks of
/// the set have it. kUsage when `only` names a scan that is not there or is locked, kBadInput for one that
/// cannot be read; kCancelled.
[[nodiscard]] Result<std::vector<ScanPose>> register_scans(const ScanSet& set, const RegisterOptions& options,
                                                           JobContext& job);

/// The one of a file's poses that is a scan's, or none: by where the scan lies in the package that the poses
/// are of, else by the scan's original name where no other has that, else by the name of its file, else by id
/// where the pose has no name or, of a scan of a session, that name.
[[nodiscard]] const ScanPose* pose_in_file(const std::vector<ScanPose>& file, const StationScan& scan);

/// The same beside the other `scans` of the set: no pose is of two. The name of a file stands behind an
/// original name; of several scans of one original name the pose is that of the one whose file is called so,
/// of a session's that of the one that has its number, else of none. Of the others number and names are
/// looked at alone.
[[nodiscard]] const ScanPose* pose_in_file(const std::vector<ScanPose>& file, const StationScan& scan,
                                           const std::vector<StationScan>& scans);
/// Whether the others have to be known for that: not where the scan's file is called as the scan is.
[[nodiscard]] bool may_share_a_pose(const StationScan& scan);
/// What to say of one that has none.
[[nodiscard]] std::string lacks_pose(const std::filesystem::path& poses_file,
                                     const std::vector<ScanPose>& file, const StationScan& scan);

[[nodiscard]] std::unexpected<Error> no_pose_of_these(const std::filesystem::path& poses_file);

/// poses.json, or a Stanford .conf, which says no unit: it is `unit`, where that is empty the one that its
/// scans in `scans`, a folder or file of them, state as theirs. kBadInput also where these differ, and where
/// two poses have one name, with one number if the scans are a session's (`scans` is that, or empty).
[[nodiscard]] Result<std::vector<ScanPose>> read_poses_file(const std::filesystem::path& poses_file,
                                                            const std::string& unit,
                                                            const std::filesystem::path& scans);

/// The poses of a file for scans of the set (matched by the scans' file names, else by id); lengths in
/// another unit than the scans' are told. kBadInput when it has none, or puts a registered scan too far from
/// the origin for float.
[[nodiscard]] Result<std::vector<ScanPose>> poses_from_file(const ScanSet& set,
                                                            const std::filesystem::path& poses_file,
                                                            const std::string& unit);

/// Whether the session has a pose of each scan. One whose last run was stopped has scans that were never
/// judged.
[[nodiscard]] bool all_judged(const ScanSet& set);

/// The poses for `plan` and `stitch`: those of the file when one is named (matched by the scans' file names,
/// else by id), those of the session when all_judged(), else a registration.
[[nodiscard]] Result<std::vector<ScanPose>> poses_for(const ScanSet& set,
                                                      const std::filesystem::path& poses_file,
                                                      const std::string& unit, JobContext& job);

/// The registered scans in their places. Refers to the set.
[[nodiscard]] std::vector<PlacedScan> placed_scans(const ScanSet& set, const std::vector<ScanPose>& poses);

}  // namespace dubsar
