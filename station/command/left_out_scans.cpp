// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/left_out_scans.h"

#include <algorithm>
#include <filesystem>

#include "core/log.h"
#include "core/utf8.h"
#include "station/stitch_warnings.h"
#include "station/tablet_flags.h"

namespace dubsar {

namespace {

const char* state_of(LeftOutScan::Why why) {
  switch (why) {
    case LeftOutScan::Why::kUnreadable:
      return "unreadable";
    case LeftOutScan::Why::kUnsure:
      return "unsure";
    case LeftOutScan::Why::kFailed:
      return "failed";
    case LeftOutScan::Why::kNoPose:
      return "no_pose";
    case LeftOutScan::Why::kNoSurface:
      return "no_surface";
    case LeftOutScan::Why::kInTheWay:
      return "in_the_way";
    case LeftOutScan::Why::kCopy:
      break;
  }
  return "copy";
}

/// Before the reason, which says by itself what it is where there is no such word.
const char* word_of(LeftOutScan::Why why) {
  switch (why) {
    case LeftOutScan::Why::kUnreadable:
      return "it cannot be read";
    case LeftOutScan::Why::kUnsure:
    case LeftOutScan::Why::kFailed:
      return state_of(why);
    case LeftOutScan::Why::kNoPose:
    case LeftOutScan::Why::kNoSurface:
    case LeftOutScan::Why::kInTheWay:
    case LeftOutScan::Why::kCopy:
      break;
  }
  return "";
}

std::string name_of(const StoredScan& scan) {
  return scan.source.empty() ? "scan " + std::to_string(scan.id) : scan.source;
}

const ScanPose* pose_of(const std::vector<ScanPose>& poses, int id) {
  const auto found = std::ranges::find(poses, id, &ScanPose::id);
  return found == poses.end() ? nullptr : &*found;
}

/// A scan of a session that cannot be read, with what opening found of its grid.
LeftOutScan unread(const SessionStore& store, const StoredScan& scan, const ScanPose* pose) {
  const std::vector<Error>& damage = store.opening().damage;
  const auto fault = std::ranges::find(damage, scan.file, &Error::where);
  return {scan.id, name_of(scan), LeftOutScan::Why::kUnreadable,
          fault != damage.end() ? fault->line() : scan.file,
          pose == nullptr || pose->status == PoseStatus::kRegistered};
}

}  // namespace

LeftOutScan left_out(const ScanPose& pose) {
  return {pose.id, pose.file,
          pose.status == PoseStatus::kUnsure ? LeftOutScan::Why::kUnsure : LeftOutScan::Why::kFailed,
          pose.reason};
}

LeftOutScan left_out(const ForeignFound& found, const std::string& file) {
  return {found.id, file, LeftOutScan::Why::kInTheWay, reason_of_all(found), true};
}

Result<std::vector<LeftOutScan>> unread_scans(const ScanSet& set) {
  std::vector<LeftOutScan> out;
  if (!set.is_session()) {
    for (const Error& error : set.left_out) {
      out.push_back({-1, std::filesystem::path(error.where).filename().string(),
                     LeftOutScan::Why::kUnreadable, error.line(), true});
    }
    return out;
  }
  const auto scans = set.store->scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  for (const StoredScan& scan : *scans) {
    if (!scan.dropped && std::ranges::find(set.scans, scan.id, &StationScan::id) == set.scans.end()) {
      out.push_back(unread(*set.store, scan, pose_of(set.poses, scan.id)));
    }
  }
  return out;
}

Result<std::vector<LeftOutScan>> left_out_of(const SessionStore& store) {
  const auto scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Result<std::vector<ScanPose>> poses = store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  std::vector<LeftOutScan> out;
  for (const StoredScan& scan : *scans) {
    const ScanPose* pose = pose_of(*poses, scan.id);
    if (scan.dropped) {
      continue;
    }
    if (scan.damaged) {
      out.push_back(unread(store, scan, pose));
    } else if (pose != nullptr && pose->status != PoseStatus::kRegistered) {
      ScanPose named = *pose;
      named.file = name_of(scan);
      out.push_back(left_out(named));
    }
  }
  return out;
}

void warn_of(const LeftOutScan& scan) {
  log_warning(left_out_sentence(one_line(scan.file), word_of(scan.why), scan.reason));
}

nlohmann::ordered_json left_out_json(const std::vector<LeftOutScan>& scans) {
  auto out = nlohmann::ordered_json::array();
  for (const LeftOutScan& scan : scans) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    if (scan.id >= 0) {
      json["id"] = scan.id;
    }
    json["file"] = scan.file;
    json["state"] = state_of(scan.why);
    json["reason"] = scan.reason;
    out.push_back(std::move(json));
  }
  return out;
}

std::ptrdiff_t unreadable_of(const std::vector<LeftOutScan>& scans) {
  return std::ranges::count(scans, LeftOutScan::Why::kUnreadable, &LeftOutScan::why);
}

bool falls_short(const std::vector<LeftOutScan>& scans) {
  return std::ranges::any_of(scans, &LeftOutScan::is_missed);
}

}  // namespace dubsar
