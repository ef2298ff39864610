// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>

#include "core/result.h"

namespace dubsar::session {

/// What a write-ahead log of SQLite holds (file format of SQLite, section "The WAL File Format").
///
/// SQLite itself stops at the first frame whose checksum does not fit and says nothing: right for the torn
/// end of a log after a power cut, and a silent loss where a disk has damaged its middle. The two can be told
/// apart, because every commit is synced before the next one is begun: a frame that is whole and comes after
/// a commit shows that this commit had reached the disk.
struct LogState {
  std::int64_t frames = 0;        ///< that SQLite plays
  std::int64_t commits = 0;       ///< in them
  std::int64_t lost_commits = 0;  ///< that had reached the disk and that SQLite does not see
  std::int64_t bytes = 0;
};

/// Reads the log once. A log that is missing or empty holds nothing. Errors: kStorage, kBadInput when it
/// cannot be read.
[[nodiscard]] Result<LogState> read_log(const std::filesystem::path& path);
/// Of a log of that many bytes.
[[nodiscard]] LogState read_log(std::istream& file, std::uintmax_t size);

/// The error that a log with lost commits is told as; `where` names the file.
[[nodiscard]] Error lost_commits_error(const LogState& log, const std::string& where);

}  // namespace dubsar::session
