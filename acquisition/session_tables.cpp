// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_tables.h"

#include <algorithm>

#include "acquisition/wall_clock.h"

namespace dubsar::session {

namespace {

constexpr const char* kSchema = R"sql(
CREATE TABLE scans(id INTEGER PRIMARY KEY, file TEXT NOT NULL, bytes INTEGER, hash INTEGER, rows INTEGER,
  cols INTEGER, samples INTEGER, spacing_mm REAL, timestamp_ns INTEGER, device TEXT, source TEXT,
  dropped INTEGER, note TEXT, sum INTEGER);
CREATE TABLE poses(id INTEGER PRIMARY KEY, json TEXT NOT NULL, sum INTEGER);
CREATE TABLE flags(id INTEGER PRIMARY KEY, count INTEGER, packed BLOB, sum INTEGER);
CREATE TABLE documents(name TEXT PRIMARY KEY, json TEXT NOT NULL, sum INTEGER);
CREATE TABLE events(number INTEGER PRIMARY KEY, time_ns INTEGER, kind TEXT, json TEXT, sum INTEGER);
CREATE TABLE files(path TEXT PRIMARY KEY, bytes INTEGER, hash INTEGER, sum INTEGER);
PRAGMA user_version = 1;
)sql";
static_assert(kSchemaVersion == 1);

int column_count(const Table& table) {
  return 1 + static_cast<int>(std::ranges::count(std::string_view(table.columns), ','));
}

std::string key_of(const Table& table) {
  const std::string_view columns(table.columns);
  return std::string(columns.substr(0, columns.find(',')));
}

/// What can be read of a table, from its first row on and, where that ends at a damaged one, from its last
/// row back.
void salvage_table(const Table& table, SqlDatabase& from, SqlDatabase& to) {
  const std::string columns(table.columns);
  const std::string select = "SELECT " + columns + " FROM " + table.name + " WHERE sum = dubsar_sum(" +
                             columns + ") ORDER BY rowid ";
  std::string insert = insert_sql(table);
  insert.replace(insert.find("REPLACE"), 7, "IGNORE");
  Result<SqlStatement> put = std::unexpected(Error{});
  for (const char* order : {"ASC", "DESC"}) {
    Result<SqlStatement> rows = from.prepare((select + order).c_str());
    if (rows && !put) {
      put = to.prepare(insert.c_str());
    }
    if (!rows || !put) {
      return;
    }
    Result<bool> row = rows->step();
    for (; row && *row; row = rows->step()) {
      for (int column = 0; column < column_count(table); ++column) {
        put->bind_column(column + 1, *rows, column);
      }
      // A row that does not go in is lost as if it could not be read; what is missing is reported by its
      // absence.
      (void)put->run();
    }
    if (row) {
      return;
    }
  }
}

}  // namespace

Status prepare_schema(SqlDatabase& db, const std::string& where) {
  const Result<std::int64_t> version = db.integer_of("PRAGMA user_version");
  if (!version) {
    return std::unexpected(version.error());
  }
  if (*version > kSchemaVersion) {
    return fail(
        ErrorKind::kUsage,
        "this session was written by a newer Dubsar (version " + std::to_string(*version) + " of its tables)",
        where, "open it with that one");
  }
  if (*version == kSchemaVersion) {
    return {};
  }
  const Result<std::int64_t> tables = db.integer_of("SELECT count(*) FROM sqlite_schema");
  if (!tables) {
    return std::unexpected(tables.error());
  }
  if (*tables != 0) {
    return bad_input(where, "the database is damaged (tables without a version)",
                     "open the session for writing to have it rebuilt from its grids");
  }
  Result<SqlTransaction> transaction = SqlTransaction::begin(db);
  if (!transaction) {
    return std::unexpected(transaction.error());
  }
  if (Status made = db.execute(kSchema); !made) {
    return made;
  }
  return transaction->commit();
}

std::string insert_sql(const Table& table) {
  std::string values;
  for (int i = 1; i <= column_count(table); ++i) {
    values += (i > 1 ? ",?" : "?") + std::to_string(i);
  }
  return std::string("INSERT OR REPLACE INTO ") + table.name + "(" + table.columns + ",sum) VALUES(" +
         values + ",dubsar_sum(" + values + "))";
}

const Table& table_named(std::string_view name) {
  return *std::ranges::find_if(kTables, [&](const Table& table) { return name == table.name; });
}

Result<std::vector<std::string>> damaged_rows(SqlDatabase& db) {
  std::vector<std::string> out;
  for (const Table& table : kTables) {
    const std::string sql = "SELECT " + key_of(table) + " FROM " + table.name +
                            " WHERE sum IS NOT dubsar_sum(" + table.columns + ")";
    Result<SqlStatement> bad = db.prepare(sql.c_str());
    if (!bad) {
      return std::unexpected(bad.error());
    }
    Result<bool> row = bad->step();
    for (; row && *row; row = bad->step()) {
      out.push_back(std::string(table.name) + " row " + bad->text(0));
    }
    if (!row) {
      return std::unexpected(row.error());
    }
  }
  return out;
}

std::int64_t salvage_rows(SqlDatabase& from, SqlDatabase& to, bool results_too) {
  std::int64_t rows = 0;
  for (const Table& table : kTables) {
    const std::string_view name(table.name);
    if (!results_too && (name == "poses" || name == "flags")) {
      continue;
    }
    salvage_table(table, from, to);
    // A value that is no value of its column (a text where a number should be, none for a key) becomes
    // another one as it is put there: such a row is no row of a session.
    const std::string unlike =
        std::string("DELETE FROM ") + table.name + " WHERE sum IS NOT dubsar_sum(" + table.columns + ")";
    (void)to.execute(unlike.c_str());
    rows += to.integer_of((std::string("SELECT count(*) FROM ") + table.name).c_str()).value_or(0);
  }
  return rows;
}

Status insert_scan(SqlDatabase& db, int id, const FileSum& sum, const RangeGrid& grid) {
  Result<SqlStatement> put = db.prepare(insert_sql(table_named("scans")).c_str());
  if (!put) {
    return std::unexpected(put.error());
  }
  put->bind(1, id).bind(2, grid_name(id)).bind(3, sum.bytes).bind(4, sum.hash);
  put->bind(5, grid.rows).bind(6, grid.cols).bind(7, static_cast<std::int64_t>(grid.valid_count()));
  put->bind(8, grid.spacing_mm).bind(9, grid.timestamp_ns).bind(10, grid.device).bind(11, grid.source);
  put->bind(12, 0).bind(13, std::string_view());
  return put->run();
}

Status insert_event(SqlDatabase& db, std::string_view kind, std::string_view json) {
  const Result<std::int64_t> last = db.integer_of("SELECT max(number) FROM events");
  if (!last) {
    return std::unexpected(last.error());
  }
  Result<SqlStatement> put = db.prepare(insert_sql(table_named("events")).c_str());
  if (!put) {
    return std::unexpected(put.error());
  }
  put->bind(1, *last + 1).bind(2, wall_clock_ns()).bind(3, kind).bind(4, json);
  return put->run();
}

}  // namespace dubsar::session
