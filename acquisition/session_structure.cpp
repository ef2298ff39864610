// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_structure.h"

#include <algorithm>
#include <string>

#include "acquisition/session_tables.h"

namespace dubsar::session {

namespace {

constexpr int kMostFaults = 1000;

/// Of tables whose key is a text, SQLite checks an index with them, and gives up where that cannot be read.
constexpr const char* kWithoutIndexes =
    "PRAGMA writable_schema = ON;"
    "DELETE FROM sqlite_schema WHERE type = 'index';"
    "UPDATE sqlite_schema SET sql = replace(sql, 'TEXT PRIMARY KEY', 'TEXT') WHERE type = 'table';"
    "PRAGMA writable_schema = RESET;";

/// A page that belongs to nothing, or to two, may have held rows.
bool tells_of_stray_pages(const std::string& fault) {
  return fault.find("never used") != std::string::npos || fault.find("2nd reference") != std::string::npos;
}

/// A table with fewer rows than its index has keys: its pages may be those of an older time, and whole.
bool index_has_more(SqlDatabase& db, const Table& table) {
  const std::string count = std::string("SELECT count(*) FROM ") + table.name;
  const std::string index = std::string("sqlite_autoindex_") + table.name + "_1";
  const auto keys = db.integer_of((count + " INDEXED BY " + index).c_str());
  const auto rows = db.integer_of((count + " NOT INDEXED").c_str());
  return keys && rows &&
         *keys > *rows;  // one without an index has no answer, as one whose index is unreadable
}

}  // namespace

bool fault_may_cost_rows(SqlDatabase& db) {
  const auto faults = db.structure_faults(kMostFaults);
  if (faults && std::ranges::any_of(*faults, tells_of_stray_pages)) {
    return true;
  }
  Result<SqlDatabase> copy = SqlDatabase::open("tables alone", SqlDatabase::Mode::kMemory);
  if (!copy || !copy->copy_from(db)) {
    return true;
  }
  copy->allow_changes_of_schema();
  if (!copy->execute(kWithoutIndexes)) {
    return true;
  }
  return std::ranges::any_of(kTables, [&](const Table& table) {
    const auto of_it = copy->structure_faults(1, table.name);
    return !of_it || !of_it->empty() || index_has_more(db, table);
  });
}

}  // namespace dubsar::session
