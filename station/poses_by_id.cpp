// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/poses_by_id.h"

#include <algorithm>
#include <system_error>

#include "core/log.h"
#include "core/result.h"
#include "station/offline.h"

namespace dubsar {

bool may_have_other_names(const std::vector<ScanPose>& file, const std::filesystem::path& scans) {
  std::error_code not_there;
  const std::filesystem::path folder =
      std::filesystem::is_directory(scans, not_there) ? scans : scans.parent_path();
  return std::ranges::all_of(file, [&](const ScanPose& pose) {
    if (pose.file.empty() || !pose.packed_as.empty()) {
      return false;
    }
    std::string name = std::filesystem::path(pose.file).filename().string();
    const bool is_there = std::filesystem::exists(folder / name, not_there);
    name.resize(std::min(name.size(), name.rfind('#')));  // one of several scans of a PTX
    return !is_there && !std::filesystem::exists(folder / name, not_there);
  });
}

void let_numbers_tell(const std::vector<StationScan>& scans, const std::filesystem::path& poses_file,
                      std::vector<ScanPose>* file) {
  const auto is_named = [&](const StationScan& scan) { return pose_in_file(*file, scan) != nullptr; };
  const auto is_numbered = [&](const StationScan& scan) {
    return std::ranges::count(*file, scan.id, &ScanPose::id) == 1;
  };
  if (scans.empty() || std::ranges::any_of(scans, is_named) || !std::ranges::all_of(scans, is_numbered)) {
    return;
  }
  log_warning(Error{ErrorKind::kBadInput,
                    "no `file` in it is the name of one of these scans, but each has its number: the poses "
                    "are taken by `id`",
                    poses_file.string(), "look whether the scans are in the same order as then"}
                  .line());
  for (ScanPose& pose : *file) {
    pose.file.clear();
  }
}

}  // namespace dubsar
