// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "acquisition/sqlite_db.h"
#include "core/result.h"

/// A database in the place of a damaged one.
namespace dubsar::session {

/// Of SQLite's log, beside its database.
inline constexpr const char* kLogSuffix = "-wal";
[[nodiscard]] std::filesystem::path beside(const std::filesystem::path& path, const std::string& suffix);
[[nodiscard]] bool has_content(const std::filesystem::path& path);

void note_rebuilding(const Error& fault, std::int64_t rows, SessionOpening& opening);
/// Fills an empty database with what is readable in the damaged file and in the backup; returns how many rows
/// that is.
[[nodiscard]] Result<std::int64_t> fill_from_remains(const std::filesystem::path& folder, SqlDatabase& to);
/// Keeps database and log, as far as they are there, under a free name, and returns what they are now called.
/// Copies, so that there is a database at every moment.
[[nodiscard]] Result<std::vector<std::string>> keep_aside(const std::filesystem::path& folder);
/// Makes a database of what is left, keeps the damaged one aside, and opens the one that is in its place.
/// Broken off at any moment, it leaves what a next one makes the same of.
[[nodiscard]] Result<SqlDatabase> rebuild(const std::filesystem::path& folder, const Error& fault,
                                          SessionOpening& opening);

}  // namespace dubsar::session
