// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/scan_pose.h"
#include "registration/foreign_matter.h"
#include "station/scan_set.h"

namespace dubsar {

/// A scan that stands and is no part of the mesh, and why.
struct LeftOutScan {
  enum class Why { kUnreadable, kUnsure, kFailed, kNoPose, kNoSurface, kInTheWay, kCopy };

  int id = -1;       ///< -1 of a folder's file that cannot be read: it has no number
  std::string file;  ///< the scan's original name
  Why why = Why::kUnreadable;
  std::string reason;      ///< may be empty
  bool is_missed = false;  ///< the mesh falls short without it: it is registered, as far as anybody knows
};

/// One whose pose is not registered.
[[nodiscard]] LeftOutScan left_out(const ScanPose& pose);
/// One that is registered, and stands in the way of others with all that it has (ForeignFound::is_all()).
[[nodiscard]] LeftOutScan left_out(const ForeignFound& found, const std::string& file);
/// The scans of a session, and the files of a folder, that could not be read, as far as anybody knows missed.
[[nodiscard]] Result<std::vector<LeftOutScan>> unread_scans(const ScanSet& set);
/// The scans of a session that cannot be read or are not registered, as its list has them. No grid is read.
[[nodiscard]] Result<std::vector<LeftOutScan>> left_out_of(const SessionStore& store);

/// Says which it is, and why.
void warn_of(const LeftOutScan& scan);
/// [{"id":3,"file":"…","state":"unreadable|unsure|failed|no_pose|no_surface|in_the_way|copy","reason":"…"}];
/// no `id` where there is none.
[[nodiscard]] nlohmann::ordered_json left_out_json(const std::vector<LeftOutScan>& scans);
/// How many of them cannot be read.
[[nodiscard]] std::ptrdiff_t unreadable_of(const std::vector<LeftOutScan>& scans);
/// Whether a mesh without these is less than it should be.
[[nodiscard]] bool falls_short(const std::vector<LeftOutScan>& scans);

}  // namespace dubsar
