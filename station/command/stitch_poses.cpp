// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/stitch_poses.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "station/conf_unit.h"
#include "station/offline.h"
#include "station/poses_by_id.h"

namespace dubsar {

namespace {

/// Of a session its list tells.
Result<std::vector<StationScan>> names_in_session(const std::string& path) {
  const Result<SessionStore> store = SessionStore::open(path, SessionStore::Access::kReadOnly);
  const auto scans = store ? store->scans() : std::unexpected(store.error());
  if (!scans) {
    return std::unexpected(scans.error());
  }
  std::vector<StationScan> names;
  for (const StoredScan& scan : *scans) {
    if (!scan.dropped && !scan.damaged) {
      StationScan& name = names.emplace_back();
      name.id = scan.id;
      name.file = scan.source.empty() ? "scan " + std::to_string(scan.id) : scan.source;
    }
  }
  return names;
}

/// What there is to say of their files is said when they are taken.
Result<std::vector<StationScan>> names_in_folder(const ScanSetArguments& arguments, JobContext& job) {
  ScanSetOptions reading = arguments.reading();
  reading.again = true;
  std::vector<StationScan> names;
  const auto take = [&](const ScanSet&, const StationScan& scan) -> Status {
    StationScan& name = names.emplace_back();
    name.id = scan.id;
    name.file = scan.file;
    name.read_from = scan.read_from;
    return {};
  };
  const Result<ScanSet> set = visit_scan_set(arguments.path, reading, take, job);
  return set ? Result<std::vector<StationScan>>(std::move(names)) : std::unexpected(set.error());
}

/// Of the poses of a file that has been read, in its order: whether `sigma_mm` is there, of which a ScanPose
/// has 0 where it is not. A .conf has no such number.
std::vector<bool> which_say_sigma(const std::string& poses_file, std::size_t count) {
  std::vector<bool> out(count, false);
  const Result<std::string> text =
      is_conf(poses_file) ? Result<std::string>(std::string()) : read_whole_file(poses_file, kMaxJsonBytes);
  const Result<JsonDocument> document =
      text ? JsonDocument::parse(*text, poses_file) : std::unexpected(text.error());
  if (document) {
    const std::vector<JsonNode> scans = document->root().at("scans").items();
    for (std::size_t k = 0; k < std::min(count, scans.size()); ++k) {
      out[k] = scans[k].find("sigma_mm").has_value();
    }
  }
  return out;
}

}  // namespace

Result<GivenPoses> GivenPoses::read(const ScanSetArguments& arguments, JobContext& job) {
  Result<std::vector<ScanPose>> file = read_poses_file(arguments.poses, arguments.unit, arguments.path);
  if (!file) {
    return std::unexpected(file.error());
  }
  GivenPoses out(arguments);
  out.poses_ = std::move(*file);
  out.says_sigma_ = which_say_sigma(arguments.poses, out.poses_.size());
  if (!SessionStore::is_session(arguments.path) && may_have_other_names(out.poses_, arguments.path)) {
    if (const Status read = out.read_names(job); !read) {
      return std::unexpected(read.error());
    }
    let_numbers_tell(*out.names_, arguments.poses, &out.poses_);
  }
  return out;
}

Status GivenPoses::read_names(JobContext& job) {
  Result<std::vector<StationScan>> names = SessionStore::is_session(arguments_->path)
                                               ? names_in_session(arguments_->path)
                                               : names_in_folder(*arguments_, job);
  if (!names) {
    return std::unexpected(names.error());
  }
  names_ = std::move(*names);
  return {};
}

Result<const ScanPose*> GivenPoses::of(const StationScan& scan, JobContext& job) {
  const ScanPose* pose = pose_in_file(poses_, scan);
  if (pose != nullptr && may_share_a_pose(scan)) {
    if (const Status read = names_ ? Status() : read_names(job); !read) {
      return std::unexpected(read.error());
    }
    pose = pose_in_file(poses_, scan, *names_);
  }
  if (pose != nullptr) {
    given_.insert(pose);
  }
  return pose;
}

std::string GivenPoses::lacks(const StationScan& scan) const {
  return lacks_pose(arguments_->poses, poses_, scan);
}

bool GivenPoses::says_sigma(const ScanPose& pose) const {
  return says_sigma_[static_cast<std::size_t>(&pose - poses_.data())];
}

std::vector<ScanPose> GivenPoses::rest() const {
  std::vector<ScanPose> out;
  for (const ScanPose& pose : poses_) {
    if (!given_.contains(&pose)) {
      out.push_back(pose);
    }
  }
  return out;
}

}  // namespace dubsar
