// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/stitch_taken.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <system_error>
#include <utility>

#include "core/log.h"
#include "station/offline.h"
#include "station/stitch_scans.h"
#include "station/stitch_warnings.h"
#include "station/tablet_flags.h"

namespace dubsar {

namespace {

void leave_out(const std::vector<ScanCopy>& copies, Taken& taken) {
  for (const ScanCopy& copy : copies) {
    taken.leave_out(
        {copy.id, taken.names.at(copy.id), LeftOutScan::Why::kCopy, copy_reason(copy, taken.names)});
  }
  for (const ScanCopy& copy : copies) {
    taken.names.erase(copy.id);
    --taken.scans;
  }
}

}  // namespace

Status leave_out_unread(const ScanSet& set, const std::filesystem::path& path,
                        const std::vector<ScanPose>* rest, Taken& taken) {
  Result<std::vector<LeftOutScan>> unread = unread_scans(set);
  if (!unread) {
    return std::unexpected(unread.error());
  }
  const bool some_lack =
      rest != nullptr && std::ranges::find(*rest, PoseStatus::kRegistered, &ScanPose::status) != rest->end();
  for (LeftOutScan& one : *unread) {
    if (rest != nullptr) {
      StationScan scan;
      scan.id = one.id;
      scan.file = one.file;
      std::error_code not_there;
      if (!set.is_session()) {
        scan.read_from = std::filesystem::absolute(path / one.file, not_there).lexically_normal();
      }
      const ScanPose* pose = pose_in_file(*rest, scan);
      one.is_missed = pose != nullptr ? pose->status == PoseStatus::kRegistered : some_lack;
    }
    taken.leave_out(std::move(one));
  }
  return {};
}

void tell_foreign(const std::vector<ForeignFound>& foreign, Taken& taken, Stitcher& stitcher) {
  for (const ForeignFound& found : foreign) {
    if (!found.is_all()) {
      log_warning(sentence_of(found));
      continue;
    }
    taken.leave_out(left_out(found, taken.names.at(found.id)));
    leave_out(take_out_with_copies(stitcher, found), taken);
    taken.names.erase(found.id);
    --taken.scans;
  }
}

void leave_out_copies(const Stitcher& stitcher, Taken& taken) {
  leave_out(stitcher.copies(), taken);
}

void leave_out_without_surface(const Stitcher& stitcher, Taken& taken) {
  for (const int id : stitcher.without_surface()) {
    taken.leave_out({id, taken.names.at(id), LeftOutScan::Why::kNoSurface, no_surface_reason()});
    taken.names.erase(id);
    --taken.scans;
  }
}

void tell_unknown_sigmas(const Taken& taken, const std::string& poses_file) {
  std::size_t unknown = 0;
  std::size_t frames = 0;  // they say 0
  for (const ScanPose& pose : taken.poses) {
    if (taken.names.contains(pose.id)) {
      const bool says = !taken.without_sigma.contains(pose.id);
      unknown += says ? 0 : 1;
      frames += says && !(pose.sigma_mm > 0) && !pose.locked ? 1 : 0;
    }
  }
  if (unknown > 0 && unknown + frames > 1) {
    log_warning(
        fmt::format("{}: {} of {} poses say no sigma_mm: what these are off by is not in the sigma of the "
                    "mesh's vertices, which is of the samples alone; dubsar register estimates it",
                    poses_file, unknown, taken.names.size()));
  }
}

}  // namespace dubsar
