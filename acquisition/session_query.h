// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "acquisition/sqlite_db.h"
#include "core/result.h"

namespace dubsar::session {

/// Runs `body()` in one transaction.
template <class Body>
Status in_transaction(SqlDatabase& db, const Body& body) {
  Result<SqlTransaction> transaction = SqlTransaction::begin(db);
  if (!transaction) {
    return std::unexpected(transaction.error());
  }
  if (Status done = body(); !done) {
    return done;
  }
  return transaction->commit();
}

/// Calls visit(row) for each row of a query.
template <class Visit>
Status for_each_row(SqlDatabase& db, const char* sql, const Visit& visit) {
  Result<SqlStatement> query = db.prepare(sql);
  if (!query) {
    return std::unexpected(query.error());
  }
  Result<bool> row = query->step();
  for (; row && *row; row = query->step()) {
    if (Status visited = visit(*query); !visited) {
      return visited;
    }
  }
  return row ? Status{} : std::unexpected(row.error());
}

/// The row of a key, whose first column says whether its checksum fits: nothing when there is none.
template <class Key>
Result<std::optional<SqlStatement>> checked_row(SqlDatabase& db, const char* sql, const Key& key,
                                                const std::string& where) {
  Result<SqlStatement> query = db.prepare(sql);
  if (!query) {
    return std::unexpected(query.error());
  }
  query->bind(1, key);
  const Result<bool> row = query->step();
  if (!row) {
    return std::unexpected(row.error());
  }
  if (!*row) {
    return std::optional<SqlStatement>();
  }
  if (query->integer(0) == 0) {
    return bad_input(where, "the stored row is damaged", "make it anew");
  }
  return std::optional(std::move(*query));
}

}  // namespace dubsar::session
