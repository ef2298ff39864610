// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/stitch_stamp.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "acquisition/session_store.h"
#include "station/results.h"
#include "station/tablet_label.h"

namespace dubsar {

Result<StitchStamp> begin_stitch(const std::filesystem::path& session, const std::filesystem::path& out,
                                 const JobContext& job) {
  const Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  if (!store) {
    return std::unexpected(store.error());
  }
  const auto scans = store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Result<std::vector<ScanPose>> poses = standing_poses(*store);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  Result<std::vector<LeftOutScan>> left_out = left_out_of(*store);
  if (!left_out) {
    return std::unexpected(left_out.error());
  }
  StitchStamp stamp{std::nullopt, std::move(*left_out)};
  std::vector<std::filesystem::path> grids;
  for (const StoredScan& scan : *scans) {
    if (scan.dropped || scan.damaged) {
      continue;
    }
    std::error_code gone;
    grids.push_back(session / scan.file);
    if (std::ranges::find(*poses, scan.id, &ScanPose::id) == poses->end() ||
        !std::filesystem::is_regular_file(grids.back(), gone)) {
      return stamp;
    }
  }
  const Result<FileLabel> label = tablet_label(*store);
  if (!label) {
    return std::unexpected(label.error());
  }
  const nlohmann::ordered_json parameters{{"label", label_lines(*label, "")},
                                          {"out", out.filename().string()},
                                          {"origin", origin_of_mesh(*poses)}};
  Result<StampedWork> work = StampedWork::begin(stamp_beside(out), "stitch", parameters.dump(), grids, job);
  if (!work) {
    return std::unexpected(work.error());
  }
  stamp.work.emplace(std::move(*work));
  return stamp;
}

}  // namespace dubsar
