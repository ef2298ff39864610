// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/sqlite_db.h"
#include "core/result.h"

/// What a session has lost of its records, kept in the record itself: an event says what could not be saved
/// when the tables were rebuilt, and a later one what a copy brought back. Events are never taken away, and
/// each has the number after the one before it: a number that is missing is a lost event, too.
namespace dubsar::session {

inline constexpr const char* kRecordsLost = "records lost";
inline constexpr const char* kBroughtBack = "records brought back";
inline constexpr const char* kAdopted = "scan adopted";

struct Losses {
  std::set<std::string> rows;  ///< "events row 12", "documents row tablet"
  bool more = false;           ///< and rows that nothing names: what stood there could not be read
  /// Whole grids that no table lists, where they prove that commits are missing; 0: they prove nothing.
  std::int64_t unlisted = 0;
  [[nodiscard]] bool any() const { return more || !rows.empty(); }
};

/// "events row 12"
[[nodiscard]] std::string row_name(std::string_view table, std::string_view key);
[[nodiscard]] bool has_row(SqlDatabase& db, const std::string& row);

/// Writes them into the record.
[[nodiscard]] Status note_losses(SqlDatabase& db, const Losses& lost);
/// `all`: nothing of what was noted before is lacking any more.
[[nodiscard]] Status note_brought_back(SqlDatabase& db, const std::vector<std::string>& rows, bool all);

/// What is lost by the record and has not come since. A result (a pose, a flag, a document, the checksum of a
/// file) that was made anew is not lost any more, nor is the row of a scan while every event is there.
[[nodiscard]] Result<Losses> standing_losses(SqlDatabase& db);

/// One error a row; `where` names the database. `folder` is what its mend is typed with.
[[nodiscard]] std::vector<Error> told_losses(const Losses& lost, const std::string& where,
                                             const std::filesystem::path& folder);

/// The error that a missing log is told as: `unlisted` whole grids are in no table.
[[nodiscard]] Error missing_log_error(std::int64_t unlisted, const std::filesystem::path& folder);

/// The session as a word of the command line that mends it: whoever reads this may sit at the window, or
/// elsewhere than where it was started.
[[nodiscard]] std::string word_of(const std::filesystem::path& folder);

}  // namespace dubsar::session
