// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/offline.h"

#include <algorithm>
#include <map>

#include "formats/poses_json.h"
#include "registration/registrar.h"

namespace dubsar {

Result<std::vector<ScanPose>> register_scans(const ScanSet& set, JobContext& job) {
  Registrar registrar;
  const PinSet* pins = set.pins ? &*set.pins : nullptr;
  for (std::size_t k = 0; k < set.scans.size(); ++k) {
    job.progress("registering", static_cast<double>(k) / static_cast<double>(set.scans.size() + 1));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    registrar.add(set.scans[k].id, set.scans[k].measured, pins, job);
  }
  if (const Status done = registrar.finalize(job); !done) {
    return std::unexpected(done.error());
  }
  job.progress("registering", 1.0);
  std::vector<ScanPose> poses = registrar.poses();
  for (ScanPose& pose : poses) {
    for (const StationScan& scan : set.scans) {
      if (scan.id == pose.id) {
        pose.file = scan.file;
      }
    }
  }
  return poses;
}

Result<std::vector<ScanPose>> poses_for(const ScanSet& set, const std::filesystem::path& poses_file,
                                        JobContext& job) {
  if (poses_file.empty()) {
    // A session whose last run was stopped has scans that were never judged.
    const bool all_judged = std::ranges::all_of(set.scans, [&](const StationScan& scan) {
      return std::ranges::any_of(set.poses, [&](const ScanPose& pose) { return pose.id == scan.id; });
    });
    return all_judged ? set.poses : register_scans(set, job);
  }
  const Result<std::vector<ScanPose>> read = read_poses(poses_file);
  if (!read) {
    return std::unexpected(read.error());
  }
  const auto name_of = [](const std::string& file) {
    return std::filesystem::path(file).filename().string();
  };
  std::vector<ScanPose> poses;
  for (const StationScan& scan : set.scans) {
    const auto by_name = std::find_if(read->begin(), read->end(), [&](const ScanPose& pose) {
      return !pose.file.empty() && name_of(pose.file) == name_of(scan.file);
    });
    const auto by_id = std::find_if(read->begin(), read->end(), [&](const ScanPose& pose) {
      return pose.file.empty() && pose.id == scan.id;
    });
    const auto found = by_name != read->end() ? by_name : by_id;
    if (found != read->end()) {
      poses.push_back(*found);
      poses.back().id = scan.id;
      poses.back().file = scan.file;
    }
  }
  if (poses.empty()) {
    return bad_input(poses_file.string(), "no pose in it is of one of these scans",
                     "its `file` or `id` must name the scans");
  }
  return poses;
}

std::vector<PlacedScan> placed_scans(const ScanSet& set, const std::vector<ScanPose>& poses) {
  std::vector<PlacedScan> placed;
  for (const StationScan& scan : set.scans) {
    for (const ScanPose& pose : poses) {
      if (pose.id == scan.id && pose.status == PoseStatus::kRegistered) {
        placed.push_back(
            {scan.id, scan.grid.get(), scan.flags.get(), pose.model_from_scanner, pose.sigma_mm});
      }
    }
  }
  return placed;
}

}  // namespace dubsar
