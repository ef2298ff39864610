// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_tables.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "acquisition/session_losses.h"
#include "acquisition/session_query.h"
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

using Wanted = std::function<bool(const std::string& key)>;

/// What can be read of a table, from its first row on and, where that ends at a damaged one, from its last
/// row back. Returns the keys of the wanted ones, which it put where there was none of the key.
std::vector<std::string> salvage_table(const Table& table, SqlDatabase& from, SqlDatabase& to,
                                       const Wanted& wanted) {
  std::vector<std::string> keys;
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
      return keys;
    }
    Result<bool> row = rows->step();
    for (; row && *row; row = rows->step()) {
      for (int column = 0; column < column_count(table); ++column) {
        put->bind_column(column + 1, *rows, column);
      }
      const std::string key = rows->text(0);  // asked for as text it is one from here on
      if (wanted && !wanted(key)) {
        continue;
      }
      // A row that does not go in is lost as if it could not be read; what is missing is reported by its
      // absence.
      (void)put->run();
      keys.push_back(key);
    }
    if (row) {
      return keys;
    }
  }
  return keys;
}

/// A value that is no value of its column (a text where a number should be, none for a key) becomes another
/// one as it is put there: such a row is no row of a session.
void take_out_unlike(const Table& table, SqlDatabase& db) {
  const std::string unlike =
      std::string("DELETE FROM ") + table.name + " WHERE sum IS NOT dubsar_sum(" + table.columns + ")";
  (void)db.execute(unlike.c_str());
}

}  // namespace

std::string key_of(const Table& table) {
  const std::string_view columns(table.columns);
  return std::string(columns.substr(0, columns.find(',')));
}

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

namespace {

/// Names them until one cannot be read.
Status name_damaged_rows(SqlDatabase& db, const Table& table, std::vector<std::string>& out) {
  const std::string sql = "SELECT " + key_of(table) + " FROM " + table.name +
                          " WHERE sum IS NOT dubsar_sum(" + table.columns + ")";
  return for_each_row(db, sql.c_str(), [&](const SqlStatement& row) -> Status {
    out.push_back(row_name(table.name, row.text(0)));
    return {};
  });
}

}  // namespace

Result<std::vector<std::string>> damaged_rows(SqlDatabase& db) {
  std::vector<std::string> out;
  for (const Table& table : kTables) {
    if (Status named = name_damaged_rows(db, table, out); !named) {
      return std::unexpected(named.error());
    }
  }
  return out;
}

DamagedRows damaged_rows_to_be_read(SqlDatabase& db) {
  DamagedRows out;
  for (const Table& table : kTables) {
    out.all_read = name_damaged_rows(db, table, out.rows).has_value() && out.all_read;
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
    (void)salvage_table(table, from, to, {});
    take_out_unlike(table, to);
    rows += to.integer_of((std::string("SELECT count(*) FROM ") + table.name).c_str()).value_or(0);
  }
  return rows;
}

std::vector<std::string> salvage_some(const Table& table, SqlDatabase& from, SqlDatabase& to,
                                      const Wanted& wanted) {
  std::vector<std::string> keys = salvage_table(table, from, to, [&](const std::string& key) {
    return !has_row(to, row_name(table.name, key)) && wanted(key);
  });
  take_out_unlike(table, to);
  std::erase_if(keys, [&](const std::string& key) { return !has_row(to, row_name(table.name, key)); });
  return keys;
}

bool results_fit(SqlDatabase& from, SqlDatabase& to) {
  for (const char* name : {"poses", "flags"}) {
    const Table& table = table_named(name);
    // A checksum is over key and content: the same sum of the same key is the same row.
    const std::string own = std::string("SELECT id, sum FROM ") + name;
    const std::string same = std::string("SELECT 1 FROM ") + name +
                             " WHERE id = ?1 AND sum = ?2 AND sum IS dubsar_sum(" + table.columns + ")";
    bool fit = true;
    const Status read = for_each_row(to, own.c_str(), [&](const SqlStatement& row) -> Status {
      Result<SqlStatement> query = from.prepare(same.c_str());
      fit = fit && query && query->bind(1, row.integer(0)).bind(2, row.integer(1)).step().value_or(false);
      return {};
    });
    if (!read || !fit) {
      return false;
    }
  }
  return true;
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

Status put_dropped(SqlDatabase& db, int id, bool dropped, std::string_view why) {
  Result<SqlStatement> mark = db.prepare(
      "UPDATE scans SET dropped = ?2, note = ?3, sum = dubsar_sum(id,file,bytes,hash,rows,cols,samples,"
      "spacing_mm,timestamp_ns,device,source,?2,?3) WHERE id = ?1");
  if (!mark) {
    return std::unexpected(mark.error());
  }
  return mark->bind(1, id).bind(2, dropped ? 1 : 0).bind(3, why).run();
}

Result<std::map<int, DropState>> dropped_by_record(SqlDatabase& db) {
  std::map<int, DropState> out;
  const Status read = for_each_row(
      db, "SELECT kind, json FROM events WHERE sum IS dubsar_sum(number,time_ns,kind,json) ORDER BY number",
      [&](const SqlStatement& row) -> Status {
        const std::string kind = row.text(0);
        if (kind != kScanDropped && kind != kScanRestored) {
          return {};
        }
        const nlohmann::json detail = nlohmann::json::parse(row.text(1), nullptr, false);
        if (!detail.is_object() || !detail.contains("id") || !detail["id"].is_number_integer()) {
          return {};
        }
        const bool dropped = kind == kScanDropped;
        const bool says_why = dropped && detail.contains("why") && detail["why"].is_string();
        out[detail["id"].get<int>()] = {dropped, says_why ? detail["why"].get<std::string>() : std::string()};
        return {};
      });
  return read ? Result<std::map<int, DropState>>(std::move(out)) : std::unexpected(read.error());
}

}  // namespace dubsar::session
