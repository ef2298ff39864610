// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_files.h"
#include "acquisition/session_losses.h"
#include "acquisition/session_store.h"
#include "acquisition/sqlite_db.h"
#include "core/result.h"

/// A database in the place of a damaged one.
namespace dubsar::session {

/// Of SQLite's log, beside its database.
inline constexpr const char* kLogSuffix = "-wal";
[[nodiscard]] std::filesystem::path beside(const std::filesystem::path& path, const std::string& suffix);
[[nodiscard]] bool has_content(const std::filesystem::path& path);

/// What a database was filled with, and what of the damaged one is not among it.
struct Salvaged {
  std::int64_t rows = 0;
  Losses lost;
};
/// Fills an empty database with what is readable in the damaged file and in the backup. `sums` are those of
/// the last close, as far as they can be read: they tell whether the backup has all that the database had.
[[nodiscard]] Result<Salvaged> fill_from_remains(const std::filesystem::path& folder, const Sums& sums,
                                                 SqlDatabase& to);
void note_rebuilding(const std::filesystem::path& folder, const Error& fault, const Salvaged& salvaged,
                     SessionOpening& opening);
/// Keeps database and log, as far as they are there, under a free name, and returns what they are now called.
/// Copies, so that there is a database at every moment; none where the same two lie aside already. What lies
/// in place of the database and is no file is moved there.
[[nodiscard]] Result<std::vector<std::string>> keep_aside(const std::filesystem::path& folder);
/// Keeps a backup that is not what the list of checksums says, and that list with it, before closing replaces
/// both; and a list that cannot be read. With `read_rows`, also one with a row that is damaged or unreadable.
[[nodiscard]] Status keep_backup_aside(const std::filesystem::path& folder, const Result<Sums>& sums,
                                       bool read_rows, SessionOpening& opening);
/// Where a rebuilding was broken off after it had taken the log away, and before it replaced the database, a
/// copy of both is left aside: that of the log, or nothing. Without it the database lacks what it held, and
/// may look whole.
[[nodiscard]] std::filesystem::path log_left_aside(const std::filesystem::path& folder);
[[nodiscard]] Error log_aside_error(const std::filesystem::path& folder, const std::filesystem::path& log);
/// Puts that log back beside the database that it belongs to.
[[nodiscard]] Status bring_back_log(const std::filesystem::path& folder);
/// Makes a database of what is left, keeps the damaged one aside, and opens the one that is in its place.
/// Broken off at any moment, it leaves what a next one makes the same of. `commits_lost`: the log had some
/// that nothing plays, which the record says then.
[[nodiscard]] Result<SqlDatabase> rebuild(const std::filesystem::path& folder, const Error& fault,
                                          const Result<Sums>& sums, bool commits_lost,
                                          SessionOpening& opening);

}  // namespace dubsar::session
