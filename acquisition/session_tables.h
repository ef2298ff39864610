// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
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

/// Names the rows whose content does not match their checksum, one line each ("poses row 3").
[[nodiscard]] Result<std::vector<std::string>> damaged_rows(SqlDatabase& db);

/// Copies every row that can be read and matches its checksum, from both ends of each table so that one
/// unreadable page costs only what lies on it. Rows that are there already stay. Without results_too, poses
/// and flags are left: they were worked out together, and an older one does not fit the others. Returns how
/// many rows of the copied tables `to` then holds.
std::int64_t salvage_rows(SqlDatabase& from, SqlDatabase& to, bool results_too);

/// Puts a grid on the list of scans. `dropped` and `note` start empty.
[[nodiscard]] Status insert_scan(SqlDatabase& db, int id, const FileSum& sum, const RangeGrid& grid);
[[nodiscard]] Status insert_event(SqlDatabase& db, std::string_view kind, std::string_view json);

}  // namespace dubsar::session
