// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/session_files.h"
#include "acquisition/sqlite_db.h"
#include "core/range_grid.h"
#include "core/result.h"

/// The tables of session.sqlite. Every row ends with the checksum of its other columns.
namespace dubsar::session {

/// PRAGMA user_version of what this program writes. A later version adds a migration per step.
inline constexpr int kSchemaVersion = 1;

struct Table {
  const char* name;
  const char* columns;  ///< all but sum, the key first
};
inline constexpr Table kTables[] = {
    {"scans", "id,file,bytes,hash,rows,cols,samples,spacing_mm,timestamp_ns,device,source,dropped,note"},
    {"poses", "id,json"},
    {"flags", "id,count,packed"},
    {"documents", "name,json"},
    {"events", "number,time_ns,kind,json"},
    {"files", "path,bytes,hash"},
};

/// Makes the tables in an empty database; refuses one of a newer version.
[[nodiscard]] Status prepare_schema(SqlDatabase& db, const std::string& where);

/// "INSERT OR REPLACE INTO t(columns,sum) VALUES(?1,…,dubsar_sum(?1,…))".
[[nodiscard]] std::string insert_sql(const Table& table);
[[nodiscard]] const Table& table_named(std::string_view name);

/// The name of its first column.
[[nodiscard]] std::string key_of(const Table& table);

/// Names the rows whose content does not match their checksum, one line each ("poses row 3").
[[nodiscard]] Result<std::vector<std::string>> damaged_rows(SqlDatabase& db);
/// The same as far as they can be read; nothing is an error.
struct DamagedRows {
  std::vector<std::string> rows;
  bool all_read = true;
};
[[nodiscard]] DamagedRows damaged_rows_to_be_read(SqlDatabase& db);

/// Copies every row that can be read and matches its checksum, from both ends of each table so that one
/// unreadable page costs only what lies on it. Rows that are there already stay. Without results_too, poses
/// and flags are left: they were worked out together, and an older one does not fit the others. Returns how
/// many rows of the copied tables `to` then holds.
std::int64_t salvage_rows(SqlDatabase& from, SqlDatabase& to, bool results_too);
/// Copies those rows of a table that `wanted` takes, by their key, and that are not there; returns their
/// keys.
[[nodiscard]] std::vector<std::string> salvage_some(
    const Table& table, SqlDatabase& from, SqlDatabase& to,
    const std::function<bool(const std::string& key)>& wanted);
/// Whether poses and flags of `from` are of the time of those that `to` has: each of these stands there, the
/// same. Worked out together, they must not be mixed. None at all fit any.
[[nodiscard]] bool results_fit(SqlDatabase& from, SqlDatabase& to);

/// Puts a grid on the list of scans. `dropped` and `note` start empty.
[[nodiscard]] Status insert_scan(SqlDatabase& db, int id, const FileSum& sum, const RangeGrid& grid);
[[nodiscard]] Status insert_event(SqlDatabase& db, std::string_view kind, std::string_view json);

inline constexpr const char* kScanStored = "scan stored";
inline constexpr const char* kScanDropped = "scan dropped";
inline constexpr const char* kScanRestored = "scan restored";
/// Marks a scan in its row, and there alone.
[[nodiscard]] Status put_dropped(SqlDatabase& db, int id, bool dropped, std::string_view why);
/// Whether a scan was taken out, and why, as the last event says that is about it; nothing where none is.
struct DropState {
  bool dropped = false;
  std::string why;
};
[[nodiscard]] Result<std::map<int, DropState>> dropped_by_record(SqlDatabase& db);

}  // namespace dubsar::session
